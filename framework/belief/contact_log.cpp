// SPDX-License-Identifier: MIT
#include "belief/contact_log.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Trust comes in steps, so that few taps rebuild a GP.
constexpr double kTrustSteps = 10.0;
constexpr double kLeastTrust = 1e-3;

}  // namespace

ContactLog::ContactLog(const HeightMapOptions& options, const Scene& scene)
    : scene_(scene), prior_(viewed_squares(options.prior, scene)), uneven_(!prior_.empty()) {
  if (const auto& offset = options.height.offset) offset_.emplace(offset->offset, offset->drift, offset->noise);
  find_object_rows();
  prior_objects_ = static_cast<int>(object_rows_.size());
}

void ContactLog::find_object_rows() {
  object_rows_.clear();
  for (int row = 0; row < size(); ++row) {
    if (datum(row).on) object_rows_.push_back(row);
  }
}

const Touch& ContactLog::datum(int row) const {
  return row < prior_size() ? prior_[static_cast<std::size_t>(row)].touch
                            : contacts_[static_cast<std::size_t>(row - prior_size())];
}

ContactLog::Reading ContactLog::read(const TapResult& result, int motion) const {
  if (!offset_) return {result.height(), scene_.on_object(result.height())};
  // While the offset is uncertain, a contact that is hardly higher than the desk is more probably the desk than so low
  // an object.
  const OffsetModel::Estimate estimate = offset_->at(seconds_, motion);
  const double height = result.height() - estimate.value;
  const double unsure =
      OffsetModel::kAboveDeskSigmas * std::sqrt(estimate.variance + offset_->noise() * offset_->noise());
  return {height, scene_.on_object(height) && height - scene_.desk() > unsure};
}

void ContactLog::add(const TapRequest& request, const TapResult& result, double noise) {
  ++taps_;
  const Target place = request.line.target();
  const double began = seconds_;
  const Reading reading = read(result, request.motion);
  seconds_ += result.seconds;
  if (!result.is_contact()) return;
  contacts_.push_back({place, reading.height - scene_.desk(), reading.on});
  tap_numbers_.push_back(taps());
  motions_.push_back(request.motion);
  const double more = request.height_noise;
  const double share = more > 0.0 ? noise * noise / (noise * noise + more * more) : 1.0;
  shares_.push_back(std::round(share * kTrustSteps) / kTrustSteps);
  uneven_ = uneven_ || shares_.back() < 1.0;
  if (reading.on) {
    object_contacts_.push_back(contacts_.back());
    object_rows_.push_back(size() - 1);
  }
  if (!offset_) return;
  raw_heights_.push_back(result.height() - scene_.desk());
  begins_.push_back(began);
  offset_->add(place, began, raw_heights_.back(), request.motion);
  read_again();
}

void ContactLog::read_again() {
  // Offsets come in steps far below the noise, so that few taps rebuild a GP.
  constexpr double kStep = 2.5e-4;
  const double noise = offset_->noise();
  object_contacts_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Touch& contact = contacts_[i];
    const OffsetModel::Estimate estimate = offset_->at(begins_[i], motions_[i]);
    contact.height = raw_heights_[i] - kStep * std::round(estimate.value / kStep);
    const bool clear = offset_->above(i) ||
                       contact.height > OffsetModel::kAboveDeskSigmas * std::sqrt(estimate.variance + noise * noise);
    const bool on = clear && scene_.on_object(scene_.desk() + contact.height);
    if (on != contact.on && i + 1 < contacts_.size()) changed_ = true;
    contact.on = on;
    if (on) object_contacts_.push_back(contact);
  }
  find_object_rows();
}

Eigen::VectorXd ContactLog::trust(const Eigen::VectorXd& outlier_probability, double noise) const {
  const double variance = noise * noise;
  Eigen::VectorXd out(size());
  for (int i = 0; i < prior_size(); ++i) {
    const double deviation = prior_[static_cast<std::size_t>(i)].deviation;
    const double more = deviation * deviation;
    out(i) = more > 0.0 ? std::max(1e-12, variance / (variance + more)) : 1.0;
  }
  const Eigen::Map<const Eigen::ArrayXd> shares(shares_.data(), static_cast<Eigen::Index>(shares_.size()));
  const auto trusted = 1.0 - (outlier_probability.array() * kTrustSteps).round() / kTrustSteps;
  out.tail(shares.size()) = (shares * trusted).max(kLeastTrust);
  return out;
}

}  // namespace palpate
