// SPDX-License-Identifier: MIT
#include "experiment/systematic.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kOther = 0.05;   // probability that a low contact is none with the bare desk
constexpr double kOthers = 0.01;  // metres, deviation of the height of what is no contact with the bare desk
// A rim of an object is where something that low was touched that near; a wall goes down to the desk.
constexpr double kRim = 0.04;     // metres of height
constexpr double kBeside = 0.03;  // metres

}  // namespace

Systematic::Systematic(double offset, double drift, double noise) : offset_(offset), drift_(drift), noise_(noise) {}

void Systematic::add(const Target& place, double seconds, double excess, bool on, int motion) {
  (on ? highs_ : lows_).push_back({place, {seconds, motion}, excess});
  judge_all();
}

bool Systematic::at_a_rim(const Target& place) const {
  return std::any_of(highs_.begin(), highs_.end(), [&](const Touched& one) {
    return one.excess < kRim && std::hypot(one.place.x - place.x, one.place.y - place.y) < kBeside;
  });
}

void Systematic::judge_all() {
  judged_.clear();
  std::vector<double> excess;
  for (const Touched& low : lows_) {
    if (at_a_rim(low.place)) continue;
    judged_.push_back(low.when);
    excess.push_back(low.excess);
  }
  // The latest tell of the drift, and of the offset as well as all.
  constexpr std::ptrdiff_t kMost = 60;
  if (static_cast<std::ptrdiff_t>(judged_.size()) > kMost) {
    judged_.erase(judged_.begin(), judged_.end() - kMost);
    excess.erase(excess.begin(), excess.end() - kMost);
  }
  const auto n = static_cast<Eigen::Index>(judged_.size());
  Testimony testimony;
  testimony.covariance = Eigen::MatrixXd::NullaryExpr(n, n, [this](Eigen::Index i, Eigen::Index j) {
    return covariance(judged_[static_cast<std::size_t>(i)], judged_[static_cast<std::size_t>(j)]);
  });
  testimony.heights = Eigen::Map<const Eigen::VectorXd>(excess.data(), n);
  testimony.suspicion = Eigen::VectorXd::Constant(n, kOther);
  testimony.signals = {1.0};
  testimony.noises = {noise_};
  testimony.lie = kOthers;
  // A few tenths of a millimetre are all there is to learn: the likeliest sets say it.
  constexpr Effort kEffort{8, 1e-3, 1e-6};
  if (n > 0) judgement_ = judge(testimony, kEffort);
}

Systematic::Estimate Systematic::at(double seconds, int motion) const {
  const When now{seconds, motion};
  Estimate out{0.0, covariance(now, now)};
  if (judged_.empty()) return out;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(judgement_.a.size());  // there is no broad signal
  z(0) = 1.0;
  for (std::size_t i = 0; i < judged_.size(); ++i) z(static_cast<Eigen::Index>(i) + 1) = covariance(now, judged_[i]);
  out.value = z.dot(judgement_.a);
  out.variance += z.dot(judgement_.b * z);
  return out;
}

}  // namespace palpate
