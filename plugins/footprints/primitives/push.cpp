// SPDX-License-Identifier: MIT
#include "push.hpp"

#include "proposals.hpp"
#include "steps.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::footprints {
namespace {

// How far a push goes: standard deviations along x and y, metres, and of the turn, radians.
constexpr double kPushed = 0.012;
constexpr double kTurned = 0.1;

/// Of a push, up to a factor.
double density(const Push& push) {
  const double angle = push.angle() / kTurned;
  return math::exp(-0.5 * ((push.dx * push.dx + push.dy * push.dy) / (kPushed * kPushed) + angle * angle));
}

Push some_push(const Area& area, Random& random) {
  Push out;
  out.origin_x = 0.5 * area.width;
  out.origin_y = 0.5 * area.depth;
  out.dx = kPushed * normal(random);
  out.dy = kPushed * normal(random);
  const double angle = kTurned * normal(random);
  out.cosine = math::cos(angle);
  out.sine = math::sin(angle);
  return out;
}

}  // namespace

void propose_push(Proposal& out, const OutlinePrior& prior, int touches, double rate, Random& random) {
  const Push from = out.push;
  out.kind = Proposal::Kind::push;
  const bool stays_before = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    // A push that was found out late has been fitted over by then: one time in two it is looked for among the latest.
    constexpr int kLately = 6;
    const int lately = std::min(kLately, touches - 1);
    const auto odds = [&](int before) {
      return rate / (0.5 / (touches - 1) + (before >= touches - lately ? 0.5 / lately : 0.0));
    };
    if (from) {
      if (stays_before) from.carry_then(out.outline);
      out.push = Push();
      out.correction = 1.0 / odds(from.before);
    } else {
      out.push = some_push(prior.settings().area, random);
      const int among = random.uniform() < 0.5 ? lately : touches - 1;
      out.push.before = touches - 1 - static_cast<int>(random.index(static_cast<std::size_t>(among)));
      if (stays_before) out.push.carry_now(out.outline);
      out.correction = odds(out.push.before);
    }
  } else {
    if (!from) return;
    if (random.uniform() < 0.25) {
      constexpr int kFar = 3;
      out.push.before += static_cast<int>(random.index(2 * kFar + 1)) - kFar;
      if (out.push.before < 1 || out.push.before >= touches) return;
    } else {
      const Steps shift(random);
      out.push.dx += 2.0 * kPushed * shift.one;
      out.push.dy += 2.0 * kPushed * shift.other;
      const double angle = from.angle() + 2.0 * kTurned * Steps(random).one;
      out.push.cosine = math::cos(angle);
      out.push.sine = math::sin(angle);
      if (stays_before) {
        from.carry_then(out.outline);
        out.push.carry_now(out.outline);
      }
    }
    out.correction = density(out.push) / density(from);
  }
  // An outline that moves along with the touches before is to them what it was, one that stays to those after.
  out.since = std::max(out.push.before, from.before);
  out.until = touches;
  if (out.push && from && out.push.before != from.before) {
    out.until = std::exchange(out.since, std::min(out.push.before, from.before));
  } else if (!stays_before) {
    out.until = std::exchange(out.since, 0);
  }
  if (!stays_before) return;
  for (Piece& piece : out.outline) {
    const double before = std::exchange(piece.density, prior.density(piece));
    out.correction *= piece.density / before;
  }
}

}  // namespace palpate::footprints
