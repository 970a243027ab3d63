// SPDX-License-Identifier: MIT
#include "experiment/pace.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// As many taps the first ideas are worth.
constexpr double kIdea = 5.0;
/// How often a tap comes to nothing, before any shows it.
constexpr double kFailures = 0.05;
/// What is farther off was no contact with the bare desk, metres.
constexpr double kFarOff = 0.02;

}  // namespace

Pace::Pace(std::shared_ptr<const Motions> motions, const Candidates& candidates, double desk)
    : motions_(std::move(motions)),
      candidates_(candidates),
      desk_(desk),
      shown_(static_cast<std::size_t>(motions_->count())),
      best_(static_cast<std::size_t>(candidates.size()), 0) {}

double Pace::success(const Shown& shown) const {
  return 1.0 - (kIdea * kFailures + shown.failed) / (kIdea + shown.taps);
}

double Pace::late(const Shown& shown) const { return shown.late / (kIdea + shown.timed); }

double Pace::deviation(int motion) const {
  const Shown& shown = shown_[static_cast<std::size_t>(motion)];
  const double idea = motions_->deviation(motion);
  return std::sqrt((kIdea * idea * idea + shown.squares) / (kIdea + shown.on_desk));
}

void Pace::look(const TapBelief& belief, const std::optional<Target>& previous) {
  const int count = candidates_.size();
  const Eigen::VectorXd& heights = belief.height_mean();
  const Eigen::VectorXd& variances = belief.height_variance();
  const Eigen::VectorXd& probability = belief.probability();
  const double noise = belief.height_noise();
  share_.setConstant(count, -1.0);
  seconds_.resize(count);
  TapRequest request;
  request.previous = previous;
  for (request.motion = 0; request.motion < motions_->count(); ++request.motion) {
    const Shown& shown = shown_[static_cast<std::size_t>(request.motion)];
    const double often = success(shown);
    const double more = late(shown);
    const double own = deviation(request.motion);
    for (int i = 0; i < count; ++i) {
      request.target = candidates_.target(i);
      const double p = probability(i);
      request.predicted = Prediction{heights(i), std::sqrt(variances(i)), p};
      const double seconds = more + p * motions_->seconds(request, std::max(desk_, heights(i))) +
                             (1.0 - p) * motions_->seconds(request, desk_);
      const double unknown = variances(i) + noise * noise;
      const double share = often * unknown / (unknown + own * own) / seconds;
      if (share <= share_(i)) continue;
      share_(i) = share;
      seconds_(i) = seconds;
      best_[static_cast<std::size_t>(i)] = request.motion;
    }
  }
}

const Eigen::VectorXd& Pace::per_second(const Eigen::VectorXd& scores) {
  worth_ = scores.cwiseProduct(share_);
  return worth_;
}

void Pace::observe(const PastTap& tap, const std::optional<Target>& previous, std::optional<double> excess) {
  if (tap.motion < 0 || tap.motion >= motions_->count()) {
    throw Error("", fmt::format("a recorded tap was made by motion {}, of which the config has {}", tap.motion, motions_->count()),
                "the record is damaged", Error::Kind::run);
  }
  Shown& shown = shown_[static_cast<std::size_t>(tap.motion)];
  ++shown.taps;
  if (tap.contact.outcome != Outcome::contact) {
    ++shown.failed;
    return;
  }
  TapRequest request;
  request.target = tap.target;
  request.previous = previous;
  request.predicted = tap.predicted;
  request.motion = tap.motion;
  shown.late += tap.contact.seconds - motions_->seconds(request, tap.contact.height);
  ++shown.timed;
  if (!excess || std::abs(*excess) > kFarOff) return;
  shown.squares += *excess * *excess;
  ++shown.on_desk;
}

}  // namespace palpate
