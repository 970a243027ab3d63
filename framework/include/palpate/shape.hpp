// SPDX-License-Identifier: MIT
// Plugin kind `shape`: the form of an object in its own frame. The scene turns, tilts and places it.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace palpate {

/// Interval on a line: distances of its two ends from the line's origin, metres.
struct LineInterval {
  double begin = 0.0;
  double end = 0.0;
};

/// Returns the union of `intervals` as disjoint intervals in ascending order.
inline std::vector<LineInterval> joined(std::vector<LineInterval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const LineInterval& a, const LineInterval& b) { return a.begin < b.begin; });
  std::vector<LineInterval> out;
  for (const LineInterval& stretch : intervals) {
    if (out.empty() || stretch.begin > out.back().end) {
      out.push_back(stretch);
    } else {
      out.back().end = std::max(out.back().end, stretch.end);
    }
  }
  return out;
}

/// A bounded solid in its own frame, metres: x along its length, y across, z up. The solid rests on the plane z = 0,
/// and the bounding rectangle of its outline from above is centred on the origin. Immutable and safe to share between
/// threads. No method throws.
///
/// The interface has lines instead of heights, because a vertical line of the scene is oblique in the frame of a tilted
/// solid.
class Shape {
 public:
  static constexpr const char* kKind = "shape";

  virtual ~Shape() = default;

  /// Returns the smallest distance from the line's origin at which the line meets the solid, negative behind the
  /// origin; +infinity without an intersection. With taps from above, lines point down; else they have any direction.
  /// Laws: if the origin moves forward along the line, the result decreases by the length of the move. All
  /// intersections are within the bounds of support().
  virtual double first_intersection(const Line& line) const = 0;

  /// Returns the largest scalar product of a point of the solid with `direction`, the extent of the solid. `direction`
  /// is finite, of any length. Laws: convex and positively homogeneous in `direction`; support({0, 0, -1}) is 0; equal
  /// along {1, 0, 0} and {-1, 0, 0}, and along {0, 1, 0} and {0, -1, 0}.
  virtual double support(const Eigen::Vector3d& direction) const = 0;

  /// Returns the height of the upright solid at (s, t) of its own frame; -infinity outside its outline. Law: the height
  /// is minus the result of first_intersection() for the line downwards from (s, t, 0). Overridden if a faster
  /// computation exists.
  virtual double top(double s, double t) const { return -first_intersection({{s, t, 0.0}, {0.0, 0.0, -1.0}}); }

  /// Returns the intervals of the line inside of the solid, in ascending order; hollow space does not count. This
  /// default is correct for convex solids; other shapes override it. Used only to compare volumes and to draw sections.
  /// Laws: the first interval begins at first_intersection(), and the last interval ends where the reversed line first
  /// meets the solid; whether a point is inside does not depend on the line through it.
  virtual std::vector<LineInterval> intervals(const Line& line) const {
    const double begin = first_intersection(line);
    const double end = -first_intersection({line.origin, -line.direction});
    return begin < end ? std::vector<LineInterval>{{begin, end}} : std::vector<LineInterval>{};
  }
};

}  // namespace palpate
