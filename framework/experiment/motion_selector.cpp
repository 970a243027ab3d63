// SPDX-License-Identifier: MIT
#include "experiment/motion_selector.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// Prior of a motion's statistics. kPriorTaps: weight of the expected values, as a number of taps; kPriorContacts:
/// expected share of taps that make contact.
constexpr double kPriorTaps = 5.0;
constexpr double kPriorContacts = 0.95;
/// Largest difference, metres, between the desk's height and the height of a contact that counts as a contact with the
/// desk.
constexpr double kMostOffDesk = 0.02;

}  // namespace

MotionSelector::MotionSelector(std::shared_ptr<const Motions> motions, double desk)
    : motions_(std::move(motions)), desk_(desk), shown_(static_cast<std::size_t>(motions_->count())) {}

double MotionSelector::deviation(int motion) const {
  const MotionStatistics& shown = shown_[static_cast<std::size_t>(motion)];
  const double idea = motions_->deviation(motion);
  return std::sqrt((kPriorTaps * idea * idea + shown.squares) / (kPriorTaps + shown.on_desk));
}

double MotionSelector::height_noise(int motion) const {
  double least = deviation(0);
  for (int other = 1; other < motions_->count(); ++other) least = std::min(least, deviation(other));
  const double own = deviation(motion);
  return std::sqrt(std::max(0.0, own * own - least * least));
}

QuantitySet MotionSelector::reads() {
  return {quantity::kHeightMean, quantity::kHeightStd, quantity::kObjectProbability};
}

void MotionSelector::choose(const Belief& belief, TapRecord& tap) const {
  TapRequest request;
  request.line = tap.request.line;
  request.previous = tap.request.previous;
  request.predicted = belief.predict(tap.candidate, true);
  const Prediction& expected = *request.predicted;
  const double p = *expected.probability;
  const double variance = expected.standard_deviation * expected.standard_deviation;
  const auto bits = [](double q) { return q > 0.0 ? -q * math::log2(q) : 0.0; };
  const double whether = bits(p) + bits(1.0 - p);
  double most = -1.0;
  for (request.motion = 0; request.motion < motions_->count(); ++request.motion) {
    const MotionStatistics& shown = shown_[static_cast<std::size_t>(request.motion)];
    const double seconds = p * motions_->seconds(request, std::max(desk_, expected.height)) +
                           (1.0 - p) * motions_->seconds(request, desk_) + shown.late / (kPriorTaps + shown.contacts);
    const double contacts = (kPriorTaps * kPriorContacts + shown.contacts) / (kPriorTaps + shown.taps);
    const double own = deviation(request.motion);
    const double how_high = p * 0.5 * math::log2(1.0 + variance / (own * own));
    const double worth = contacts * (whether + how_high) / seconds;
    if (worth <= most) continue;
    most = worth;
    tap.request.motion = request.motion;
    tap.expected_seconds = seconds;
  }
}

void MotionSelector::take_in(const TapRecord& tap, const Belief& belief) {
  const int motion = tap.request.motion;
  if (motion < 0 || motion >= motions_->count())
    throw Error(
        "",
        fmt::format("a recorded tap was made by motion {}, but the config has {} motions", motion, motions_->count()),
        "the record is damaged", Error::Kind::run);
  motion_of_tap_.push_back(motion);
  MotionStatistics& shown = shown_[static_cast<std::size_t>(motion)];
  ++shown.taps;
  if (tap.is_contact()) {
    ++shown.contacts;
    shown.late += tap.result.seconds - motions_->seconds(tap.request, tap.result.height());
  }
  read_desk(belief);
}

void MotionSelector::read_desk(const Belief& belief) {
  for (MotionStatistics& shown : shown_) {
    shown.squares = 0.0;
    shown.on_desk = 0;
  }
  for (const TapReading& one : belief.taps().readings) {
    const double height = one.position.z() - desk_;
    if (one.on_object || std::abs(height) > kMostOffDesk) continue;
    MotionStatistics& shown = shown_[static_cast<std::size_t>(motion_of_tap_[static_cast<std::size_t>(one.tap - 1)])];
    shown.squares += height * height;
    ++shown.on_desk;
  }
}

}  // namespace palpate
