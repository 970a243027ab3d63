// SPDX-License-Identifier: MIT
// What the shapes share: the part of a line that lies in a convex set, and an option.
#pragma once

#include <palpate/options.hpp>

#include <algorithm>
#include <limits>

namespace palpate::shapes {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The part of a line that lies in a convex set; empty when begin > end.
struct Interval {
  double begin = -kInfinity;
  double end = kInfinity;

  bool empty() const { return begin > end; }
  /// Its begin; infinity when empty.
  double first() const { return empty() ? kInfinity : begin; }
  void clear() { begin = kInfinity, end = -kInfinity; }

  /// Keeps the x with slope * x <= room.
  void clip(double slope, double room) {
    if (slope > 0.0) {
      end = std::min(end, room / slope);
    } else if (slope < 0.0) {
      begin = std::max(begin, room / slope);
    } else if (room < 0.0) {
      clear();
    }
  }

  /// Keeps what lies between two parallel planes: low <= origin + slope * x <= high.
  void clip(double origin, double slope, double low, double high) {
    clip(slope, high - origin);
    clip(-slope, origin - low);
  }
};

/// The option of all that has one height.
inline void list_height(double& height, Fields& fields) {
  fields.real(height, Field("height", "of the top above the desk, upright").in(Unit::metre).above(0));
}

}  // namespace palpate::shapes
