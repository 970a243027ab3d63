// SPDX-License-Identifier: MIT
#include "belief/outlier_model.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Halves the log odds of probabilities above one half. Real surfaces have steps that a GP does not expect, so the
/// computed probabilities of outliers are too close to 1. Without this correction, 83 % of 402 contacts with a
/// probability of 90 % or more were outliers.
double tempered(double probability) {
  if (probability <= 0.5) return probability;
  const double odds = std::sqrt(probability / (1.0 - probability));
  return std::isfinite(odds) ? odds / (1.0 + odds) : 1.0;
}

}  // namespace

bool OutlierModel::update(const ContactLog& log, const GpModel& objects, const Footprint* footprint) {
  // The cost grows with the cube of the contacts on an object. With more than kMostContacts, the surface is so well
  // determined that an outlier hardly matters: later contacts are trusted, and earlier ones keep their probabilities.
  constexpr std::size_t kMostContacts = 100;
  const auto contacts = static_cast<Eigen::Index>(log.contacts().size());
  if (log.object_contacts().size() > kMostContacts) {
    const Eigen::Index known = probabilities_.size();
    for (Eigen::VectorXd* values : {&probabilities_, &by_label_}) {
      values->conservativeResize(contacts);
      values->tail(contacts - known).setZero();
    }
    return false;
  }
  Eigen::VectorXd label_error = Eigen::VectorXd::Zero(log.size());
  if (footprint != nullptr) footprint->doubt(label_error);
  by_label_ = label_error.tail(contacts);
  probabilities_ = by_label_;
  // Squares of the camera's view cannot be outliers; their heights are only less exact.
  const auto objects_count = static_cast<Eigen::Index>(log.object_rows().size());
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(objects_count);
  Eigen::VectorXd roughness = Eigen::VectorXd::Zero(log.prior_size() > 0 ? objects_count : 0);
  for (Eigen::Index i = 0; i < objects_count; ++i) {
    const int row = log.object_rows()[static_cast<std::size_t>(i)];
    if (row < log.prior_size()) {
      const double deviation = log.prior()[static_cast<std::size_t>(row)].deviation;
      roughness(i) = deviation * deviation;
    } else {
      const double mislabelled = by_label_(row - log.prior_size());
      prior(i) = mislabelled + (1.0 - mislabelled) * prior_;
    }
  }
  surface_.update(objects.process(), prior, roughness);
  for (Eigen::Index i = log.prior_objects(); i < objects_count; ++i) {
    const int row = log.object_rows()[static_cast<std::size_t>(i)];
    probabilities_(row - log.prior_size()) = tempered(surface_.outlier_probabilities()(i));
  }
  return true;
}

}  // namespace palpate
