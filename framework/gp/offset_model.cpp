// SPDX-License-Identifier: MIT
#include "gp/offset_model.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kOther = 0.05;  // probability that a low contact is not a contact with the bare desk
// metres: standard deviation of the height of a low contact that is not with the bare desk
constexpr double kOthers = 0.01;
// A low contact within kBeside of an object contact below kRim may be at the rim of the object. Objects with higher
// contacts are assumed to have walls that reach down to the desk.
constexpr double kRim = 0.04;     // metres above the desk
constexpr double kBeside = 0.03;  // metres

}  // namespace

void OffsetModel::add(const Target& place, double seconds, double excess, int motion) {
  const auto known = std::find(motions_.begin(), motions_.end(), motion);
  const Eigen::Index own = known - motions_.begin();
  if (known == motions_.end()) motions_.push_back(motion);
  touched_.push_back({place, {seconds, motion}, own, excess});
  find_desk();
  judge_all();
}

void OffsetModel::find_desk() {
  const std::size_t contacts = touched_.size();
  std::vector<bool> left(contacts, true);  // contacts that take part in the search; single low contacts are removed
  above_ = left;
  search_from_below(above_);
  std::vector<bool> found = above_;
  for (;;) {
    std::vector<std::size_t> lows;
    for (std::size_t i = 0; i < contacts; ++i) {
      if (left[i] && !found[i]) lows.push_back(i);
    }
    if (lows.size() > 1) above_ = found;
    // With 0 low contacts, no two low contacts agree, and above_ keeps the result of the first search.
    if (lows.size() != 1) return;
    left[lows.front()] = false;
    found = left;
    search_from_below(found);
  }
}

/// Removes the contacts with the desk from `left`. Contacts that are clearly above the desk remain.
void OffsetModel::search_from_below(std::vector<bool>& left) const {
  // Linear regression that is equivalent to the GP of covariance(). Its coefficients are the common offset, the drift,
  // and the offset of each motion.
  const auto motions = static_cast<Eigen::Index>(motions_.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(2 + motions);
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(2 + motions, (1.0 - kShared) * prior_.offset * prior_.offset);
  prior.head<2>() << kShared * prior_.offset * prior_.offset, prior_.drift * prior_.drift;
  Eigen::MatrixXd covariance = prior.asDiagonal();
  for (;;) {
    double lowest = kAboveDeskSigmas;
    double deviation = 0.0;
    std::size_t next = touched_.size();
    for (std::size_t i = 0; i < touched_.size(); ++i) {
      if (!left[i]) continue;
      const double t = touched_[i].when.seconds;
      const Eigen::Index own = 2 + touched_[i].own;
      const double variance = covariance(0, 0) + t * t * covariance(1, 1) + covariance(own, own) +
                              2.0 * (t * covariance(0, 1) + covariance(0, own) + t * covariance(1, own));
      const double wide = std::sqrt(std::max(variance, 0.0) + prior_.noise * prior_.noise);
      const double above = (touched_[i].excess - mean(0) - t * mean(1) - mean(own)) / wide;
      if (above >= lowest) continue;
      lowest = above;
      deviation = wide;
      next = i;
    }
    if (next == touched_.size()) return;
    left[next] = false;
    const Eigen::VectorXd gain =
        (covariance.col(0) + touched_[next].when.seconds * covariance.col(1) + covariance.col(2 + touched_[next].own)) /
        deviation;
    mean += gain * lowest;
    covariance.noalias() -= gain * gain.transpose();
  }
}

bool OffsetModel::at_a_rim(const Target& place) const {
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const OffsetContact& one = touched_[i];
    if (above_[i] && one.excess < kRim && math::hypot(one.place.x - place.x, one.place.y - place.y) < kBeside)
      return true;
  }
  return false;
}

void OffsetModel::judge_all() {
  judged_.clear();
  std::vector<double> excess;
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const OffsetContact& low = touched_[i];
    if (above_[i] || at_a_rim(low.place)) continue;
    judged_.push_back(low.when);
    excess.push_back(low.excess);
  }
  // Only the latest contacts are used. They determine the drift, and they suffice for the offset.
  constexpr std::ptrdiff_t kMost = 60;
  if (static_cast<std::ptrdiff_t>(judged_.size()) > kMost) {
    judged_.erase(judged_.begin(), judged_.end() - kMost);
    excess.erase(excess.begin(), excess.end() - kMost);
  }
  const auto n = static_cast<Eigen::Index>(judged_.size());
  OutlierProblem problem;
  problem.covariance = Eigen::MatrixXd::NullaryExpr(n, n, [this](Eigen::Index i, Eigen::Index j) {
    return covariance(judged_[static_cast<std::size_t>(i)], judged_[static_cast<std::size_t>(j)]);
  });
  problem.heights = Eigen::Map<const Eigen::VectorXd>(excess.data(), n);
  problem.prior = Eigen::VectorXd::Constant(n, kOther);
  problem.signals = {1.0};
  problem.noises = {prior_.noise};
  problem.outlier_deviation = kOthers;
  // More sets of outliers would change the offset by only a few tenths of a millimetre, so the most probable sets
  // suffice.
  constexpr OutlierSearchLimits kLimits{8, 1e-3, 1e-6};
  if (n > 0) posterior_ = infer_outliers(problem, kLimits);
}

OffsetModel::Estimate OffsetModel::at(double seconds, int motion) const {
  const OffsetInput now{seconds, motion};
  Estimate out{0.0, covariance(now, now)};
  if (judged_.empty()) return out;
  // Number of coefficients: the constant and one per contact. The coefficients of the broad signal are unused here.
  const auto size = static_cast<Eigen::Index>(judged_.size()) + 1;
  Eigen::VectorXd z(size);
  z(0) = 1.0;
  for (Eigen::Index i = 1; i < size; ++i) z(i) = covariance(now, judged_[static_cast<std::size_t>(i - 1)]);
  out.value = z.dot(posterior_.a.head(size));
  out.variance += z.dot(posterior_.b.topLeftCorner(size, size) * z);
  return out;
}

}  // namespace palpate
