// SPDX-License-Identifier: MIT
#include "simulator/tool.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::backends {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kRings = 8;
constexpr int kSpokes = 24;
constexpr double kFinest = 1e-8;  ///< metres

/// The largest height(x + dx, y + dy) - rise(distance) over a disc, or `least` if none is larger. `rise` is how much
/// higher than its lowest point the tool is at a distance from its axis; it never falls.
template <class Rise>
double search(const Scene& scene, double x, double y, double radius, double least, Rise rise) {
  double best = least;
  double at_x = 0.0;
  double at_y = 0.0;
  const auto attempt = [&](double dx, double dy) {
    const double distance = std::hypot(dx, dy);
    if (distance > radius) return false;
    const double value = scene.height(x + dx, y + dy) - rise(distance);
    if (!(value > best)) return false;
    best = value;
    at_x = dx;
    at_y = dy;
    return true;
  };
  for (int ring = 1; ring <= kRings; ++ring) {
    const double distance = radius * ring / kRings * (1.0 - 1e-12);  // the rim belongs to the disc, rounded or not
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2.0 * kPi * spoke / kSpokes;
      attempt(distance * std::cos(angle), distance * std::sin(angle));
    }
  }
  if (best == least) return best;
  for (double stride = radius / kRings; stride > kFinest; stride /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int i = 0; i < 8; ++i) {
        const double angle = kPi / 4 * i;
        moved = attempt(at_x + stride * std::cos(angle), at_y + stride * std::sin(angle)) || moved;
      }
    }
  }
  return best;
}

}  // namespace

double contact_height(const Scene& scene, const Effects& effects, double x, double y) {
  double height = scene.height(x, y);
  if (effects.tip_radius) {
    const double radius = effects.tip_radius->radius;
    height = search(scene, x, y, radius, height, [radius](double distance) {
      return radius - std::sqrt(std::max(0.0, radius * radius - distance * distance));
    });
  }
  if (effects.shaft) {
    const double length = effects.shaft->length;
    // Cheaper than a search, and nearly always enough: nothing is that tall.
    if (scene.highest() - length > height) {
      height = search(scene, x, y, effects.shaft->radius, height, [length](double) { return length; });
    }
  }
  return height;
}

}  // namespace palpate::backends
