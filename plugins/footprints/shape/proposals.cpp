// SPDX-License-Identifier: MIT
#include "proposals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpate::footprints {
namespace {

// Greatest steps; each is made smaller by a factor down to a thirtieth, for posteriors of all widths.
constexpr double kShift = 0.07;   // metres
constexpr double kTurn = 1.4;     // radians
constexpr double kStretch = 0.9;  // of a logarithm
constexpr int kScales = 16;

/// Factors of the steps, their logarithms evenly spaced: a look-up is quicker than a power.
double some_scale(Random& random) {
  static const std::array<double, kScales> scales = [] {
    std::array<double, kScales> out{};
    for (int i = 0; i < kScales; ++i) out[static_cast<std::size_t>(i)] = std::pow(1.0 / 30.0, i / (kScales - 1.0));
    return out;
  }();
  return scales[static_cast<std::size_t>(random.bits() % kScales)];
}

constexpr double kNear = 0.03;  // metres: standard deviation, along x and y, of a new piece from a wrong label

/// Standard normal (Box and Muller 1958).
double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

/// Uniform in (-1, 1]: as good as a normal step where steps are of all sizes anyway, and quicker.
double either_way(Random& random) { return 1.0 - 2.0 * random.uniform(); }

/// Moves a side and leaves the one across from it. Returns the correction: even steps in the length of a half axis are
/// uneven ones in its logarithm.
double move_side(Piece& piece, double scale, Random& random) {
  const bool along = random.uniform() < 0.5;
  double& half = along ? piece.a : piece.b;
  const double before = half;
  const double change = 0.5 * kShift * scale * either_way(random);
  half += change;
  if (half <= 0.0) return 0.0;
  const double side = random.uniform() < 0.5 ? change : -change;
  piece.x += side * (along ? piece.cosine : -piece.sine);
  piece.y += side * (along ? piece.sine : piece.cosine);
  const double correction = before / half;
  piece.order_axes();
  return correction;
}

void change_family(Piece& piece) {
  constexpr double kSameExtent = 1.1283791670955126;  // an ellipse as large as a box is longer by this
  const bool box = piece.family == Piece::Family::box;
  piece.family = box ? Piece::Family::ellipse : Piece::Family::box;
  piece.a *= box ? kSameExtent : 1.0 / kSameExtent;
  piece.b *= box ? kSameExtent : 1.0 / kSameExtent;
}

/// The labels of one piece that a second piece of a kind could set right.
std::vector<Target> repairable(const Piece& piece, Outline::Kind kind, const std::vector<Touch>& touches) {
  std::vector<Target> out;
  const bool adds = kind == Outline::Kind::two;
  for (const Touch& touch : touches) {
    if (touch.on == adds && piece.contains(touch.place.x, touch.place.y) != adds) out.push_back(touch.place);
  }
  return out;
}

/// How much less often the centre of the second piece is proposed than the prior has it.
double second_correction(const Outline& outline, const OutlinePrior& prior, const std::vector<Target>& near) {
  if (near.empty()) return 1.0;
  const double by_prior = prior.second_centre_density(outline);
  double by_labels = 0.0;
  for (const Target& place : near) {
    const double dx = (outline.second.x - place.x) / kNear;
    const double dy = (outline.second.y - place.y) / kNear;
    by_labels += std::exp(-0.5 * (dx * dx + dy * dy));
  }
  by_labels /= 2.0 * kPi * kNear * kNear * static_cast<double>(near.size());
  return by_prior / (0.5 * by_prior + 0.5 * by_labels);
}

/// Adds or takes away the second piece, or names the two pieces the other way round.
double change_kind(Outline& outline, Outline::Kind kind, const OutlinePrior& prior, const std::vector<Touch>& touches,
                   Random& random) {
  if (outline.kind == Outline::Kind::two && kind != Outline::Kind::two) {
    std::swap(outline.first, outline.second);
    return 1.0;
  }
  const std::vector<Target> near = repairable(outline.first, kind, touches);
  if (outline.kind == kind) {
    const double correction = second_correction(outline, prior, near);
    outline.kind = Outline::Kind::one;
    return 1.0 / (prior.odds(kind) * correction);
  }
  if (outline.kind != Outline::Kind::one) return 0.0;
  outline.kind = kind;
  outline.second = prior.draw_second(kind, outline.first, random);
  if (!near.empty() && random.uniform() < 0.5) {
    const Target& place = near[random.index(near.size())];
    outline.second.x = place.x + kNear * normal(random);
    outline.second.y = place.y + kNear * normal(random);
  }
  return prior.odds(kind) * second_correction(outline, prior, near);
}

// How far a push goes: standard deviations along x and y, metres, and of the turn, radians.
constexpr double kPushed = 0.012;
constexpr double kTurned = 0.1;

/// Of a push, up to a factor.
double density(const Push& push) {
  const double angle = push.angle() / kTurned;
  return std::exp(-0.5 * ((push.dx * push.dx + push.dy * push.dy) / (kPushed * kPushed) + angle * angle));
}

Push some_push(const Area& area, Random& random) {
  Push out;
  out.origin_x = 0.5 * area.width;
  out.origin_y = 0.5 * area.depth;
  out.dx = kPushed * normal(random);
  out.dy = kPushed * normal(random);
  const double angle = kTurned * normal(random);
  out.cosine = std::cos(angle);
  out.sine = std::sin(angle);
  return out;
}

}  // namespace

Proposal propose(const State& from, const OutlinePrior& prior, const std::vector<Touch>& touches, Random& random) {
  Proposal out{from, 1.0};
  Outline& to = out.outline;
  const double which = random.uniform();
  if (which < 0.02) {
    to = prior.draw(random);
    out.density = prior.density(to);
    return out;
  }
  if (which < 0.14) {
    // As many of the moves add as take away, for each kind, so that these shares cancel.
    const auto kind = which < 0.08 ? Outline::Kind::two : Outline::Kind::without;
    out.correction = change_kind(to, kind, prior, touches, random);
    out.density = prior.density(to);
    if (out.density <= 0.0) out.correction = 0.0;
    return out;
  }

  Piece& piece = from.outline.kind == Outline::Kind::one || random.uniform() < 0.5 ? to.first : to.second;
  const double scale = some_scale(random);
  if (which < 0.46) {
    piece.x += kShift * scale * either_way(random);
    piece.y += kShift * scale * either_way(random);
  } else if (which < 0.64) {
    piece.turn(kTurn * scale * either_way(random));
  } else if (which < 0.81) {
    piece.a *= std::exp(kStretch * scale * either_way(random));
    piece.b *= std::exp(kStretch * scale * either_way(random));
    piece.order_axes();
  } else if (which < 0.97) {
    out.correction = move_side(piece, scale, random);
  } else {
    change_family(piece);
  }
  out.density = out.correction > 0.0 ? prior.density(to) : 0.0;
  out.correction *= out.density / from.density;
  return out;
}

Proposal propose_push(const State& from, const OutlinePrior& prior, int touches, double rate, Random& random) {
  Proposal out{from, 0.0};
  const bool stays_before = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    // A push that was found out late has been fitted over by then: one time in two it is looked for among the latest.
    constexpr int kLately = 6;
    const int lately = std::min(kLately, touches - 1);
    const auto odds = [&](int before) {
      return rate / (0.5 / (touches - 1) + (before >= touches - lately ? 0.5 / lately : 0.0));
    };
    if (from.push) {
      if (stays_before) out.outline = from.push.then(from.outline);
      out.push = Push();
      out.correction = 1.0 / odds(from.push.before);
    } else {
      out.push = some_push(prior.area(), random);
      const int among = random.uniform() < 0.5 ? lately : touches - 1;
      out.push.before = touches - 1 - static_cast<int>(random.index(static_cast<std::size_t>(among)));
      if (stays_before) out.outline = out.push.now(from.outline);
      out.correction = odds(out.push.before);
    }
  } else {
    if (!from.push) return out;
    if (random.uniform() < 0.25) {
      constexpr int kFar = 3;
      out.push.before += static_cast<int>(random.index(2 * kFar + 1)) - kFar;
      if (out.push.before < 1 || out.push.before >= touches) return out;
    } else {
      const double scale = some_scale(random);
      out.push.dx += 2.0 * kPushed * scale * either_way(random);
      out.push.dy += 2.0 * kPushed * scale * either_way(random);
      const double angle = from.push.angle() + 2.0 * kTurned * scale * either_way(random);
      out.push.cosine = std::cos(angle);
      out.push.sine = std::sin(angle);
      if (stays_before) out.outline = out.push.now(from.push.then(from.outline));
    }
    out.correction = density(out.push) / density(from.push);
  }
  out.density = prior.density(out.outline);
  out.correction *= out.density / from.density;
  return out;
}

}  // namespace palpate::footprints
