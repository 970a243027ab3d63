// SPDX-License-Identifier: MIT
#include "scene/placement.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Returns whether a vertical plane with the normal (dx, dy) separates two bodies. The normal has unit length and
/// points from `a` to `b`.
bool separates(const Body& a, const Body& b, double dx, double dy) {
  return a.reach(dx, dy) + b.reach(-dx, -dy) <= dx * (b.x() - a.x()) + dy * (b.y() - a.y());
}

/// Returns the largest distance by which the body reaches beyond the area, metres; not positive if it lies inside.
double beyond(const Body& body, const Area& area) {
  return std::max({body.reach(-1, 0) - body.x(), body.x() - (area.width - body.reach(1, 0)),
                   body.reach(0, -1) - body.y(), body.y() - (area.depth - body.reach(0, 1))});
}

/// Draws poses until the body lies inside the area.
void draw_inside(Body& body, const Area& area, Random& random, std::size_t number) {
  constexpr int kTries = 100'000;
  for (int i = 0; i < kTries; ++i) {
    const double rotation = 2.0 * kPi * random.uniform();
    const double x = area.width * random.uniform();
    const double y = area.depth * random.uniform();
    body.place(x, y, rotation);
    if (beyond(body, area) <= 0.0) return;
  }
  throw Error(fmt::format("scene.objects.{}", number), "does not fit into the area",
              "make the object smaller or the area larger");
}

/// Returns whether a vertical plane separates two bodies. May return false for bodies closer than a thousandth of their
/// size, but never returns true for bodies that overlap.
bool separate(const Body& a, const Body& b) {
  const double dx = b.x() - a.x();
  const double dy = b.y() - a.y();
  const double distance = math::hypot(dx, dy);
  if (distance == 0.0) return false;
  const double along = dx / distance;
  const double across = dy / distance;
  // Directions near the line between the centres come first, because they separate most pairs.
  constexpr int kDirections = 180;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 0.5 * kPi * i / kDirections;
    const double cosine = math::cos(angle);
    const double sine = math::sin(angle);
    if (separates(a, b, cosine * along - sine * across, cosine * across + sine * along)) return true;
    if (separates(a, b, cosine * along + sine * across, cosine * across - sine * along)) return true;
  }
  return false;
}

bool all_separate(const std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!separate(bodies[j], bodies[i])) return false;
    }
  }
  return true;
}

}  // namespace

void check_inside(const std::vector<Body>& bodies, const Area& area) {
  constexpr double kRounding = 1e-9;
  constexpr double kMillimetre = 1e-3;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double outside = beyond(bodies[i], area);
    if (outside <= kRounding) continue;
    throw Error(fmt::format("scene.objects.{}", i),
                fmt::format("reaches {:.3g} mm beyond the area of {:.6g} x {:.6g} mm", outside / kMillimetre,
                            area.width / kMillimetre, area.depth / kMillimetre),
                "move it by 'at', turn it, or make the area larger");
  }
}

void place_at_random(std::vector<Body>& bodies, const Area& area, std::uint64_t seed) {
  std::vector<Random> streams;
  for (std::size_t i = 0; i < bodies.size(); ++i) streams.emplace_back(seed, "scene/placement", i);
  // All poses are drawn again if any two bodies overlap. If only one body were drawn again, the poses would not be
  // uniformly distributed.
  constexpr int kRounds = 10'000;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < bodies.size(); ++i) draw_inside(bodies[i], area, streams[i], i);
    if (all_separate(bodies)) return;
  }
  throw Error("scene.objects", fmt::format("found no placement for all {} objects in {} draws", bodies.size(), kRounds),
              "make them smaller or fewer, or the area larger");
}

bool push_about(std::vector<Body>& bodies, const Area& area, const Push& push, std::uint64_t seed, int taps) {
  // After this many draws the body stays in its place, because other bodies or the edge of the area leave no free pose.
  constexpr int kTries = 100;
  bool moved = false;
  for (int tap = 1; tap <= taps; ++tap) {
    Random random(seed, "scene/push", static_cast<std::uint64_t>(tap));
    const bool happens = push.after ? tap == *push.after : random.uniform() < push.probability;
    if (!happens || bodies.empty()) continue;
    Body& body = bodies[random.index(bodies.size())];
    const Body before = body;
    for (int i = 0; i < kTries; ++i) {
      const double direction = 2.0 * kPi * random.uniform();
      const double turn = push.turn * (2.0 * random.uniform() - 1.0);
      body.place(before.x() + push.distance * math::cos(direction), before.y() + push.distance * math::sin(direction),
                 before.rotation() + turn);
      if (beyond(body, area) <= 0.0 && all_separate(bodies)) break;
      body = before;
    }
    moved = moved || body.x() != before.x() || body.y() != before.y();
  }
  return moved;
}

}  // namespace palpate
