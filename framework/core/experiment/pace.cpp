// SPDX-License-Identifier: MIT
#include "experiment/pace.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// As many taps a motion's own idea of itself is worth, and how often it thinks to come to a contact.
constexpr double kIdea = 5.0;
constexpr double kContacts = 0.95;
/// Metres: what is farther off was no contact with the bare desk.
constexpr double kFarOff = 0.02;

}  // namespace

Pace::Pace(std::shared_ptr<const Motions> motions, double desk)
    : motions_(std::move(motions)), desk_(desk), shown_(static_cast<std::size_t>(motions_->count())) {}

double Pace::deviation(int motion) const {
  const Shown& shown = shown_[static_cast<std::size_t>(motion)];
  const double idea = motions_->deviation(motion);
  return std::sqrt((kIdea * idea * idea + shown.squares) / (kIdea + shown.on_desk));
}

double Pace::roughness(int motion) const {
  double least = deviation(0);
  for (int other = 1; other < motions_->count(); ++other) least = std::min(least, deviation(other));
  const double own = deviation(motion);
  return std::sqrt(std::max(0.0, own * own - least * least));
}

Pace::Choice Pace::choose(const TapBelief& belief, int candidate, const Target& place,
                          const std::optional<Target>& previous) const {
  TapRequest request;
  request.target = place;
  request.previous = previous;
  request.predicted = belief.predict(candidate, kReads);
  const Prediction& expected = *request.predicted;
  const double p = *expected.probability;
  const double variance = expected.standard_deviation * expected.standard_deviation;
  const auto bits = [](double q) { return q > 0.0 ? -q * math::log2(q) : 0.0; };
  const double whether = bits(p) + bits(1.0 - p);
  Choice best;
  double most = -1.0;
  for (request.motion = 0; request.motion < motions_->count(); ++request.motion) {
    const Shown& shown = shown_[static_cast<std::size_t>(request.motion)];
    const double seconds = p * motions_->seconds(request, std::max(desk_, expected.height)) +
                           (1.0 - p) * motions_->seconds(request, desk_) + shown.late / (kIdea + shown.contacts);
    const double contacts = (kIdea * kContacts + shown.contacts) / (kIdea + shown.taps);
    const double own = deviation(request.motion);
    const double how_high = p * 0.5 * math::log2(1.0 + variance / (own * own));
    const double worth = contacts * (whether + how_high) / seconds;
    if (worth <= most) continue;
    most = worth;
    best = {request.motion, seconds};
  }
  return best;
}

void Pace::observe(const PastTap& tap, const std::optional<Target>& previous) {
  if (tap.motion < 0 || tap.motion >= motions_->count()) {
    throw Error("",
                fmt::format("a recorded tap was made by motion {}, but the config has {} motions", tap.motion,
                            motions_->count()),
                "the record is damaged", Error::Kind::run);
  }
  Shown& shown = shown_[static_cast<std::size_t>(tap.motion)];
  ++shown.taps;
  if (tap.contact.outcome != Outcome::contact) return;
  ++shown.contacts;
  TapRequest request;
  request.target = tap.target;
  request.previous = previous;
  request.predicted = tap.predicted;
  request.motion = tap.motion;
  shown.late += tap.contact.seconds - motions_->seconds(request, tap.contact.height);
}

void Pace::see_desk(const std::vector<Touch>& touches, const std::vector<int>& motions) {
  for (Shown& shown : shown_) {
    shown.squares = 0.0;
    shown.on_desk = 0;
  }
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    if (touch.on || std::abs(touch.height) > kFarOff) continue;
    Shown& shown = shown_[static_cast<std::size_t>(motions[i])];
    shown.squares += touch.height * touch.height;
    ++shown.on_desk;
  }
}

}  // namespace palpate
