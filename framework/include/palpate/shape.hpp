// SPDX-License-Identifier: MIT
// The form of an object, apart from where it stands. The scene turns, tilts and places it.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace palpate {

/// A part of a line, between two distances from its origin, metres.
struct Stretch {
  double begin = 0.0;
  double end = 0.0;
};

/// The parts of a line that lie in any of `intervals`: in their order, none meeting another.
inline std::vector<Stretch> joined(std::vector<Stretch> intervals) {
  std::sort(intervals.begin(), intervals.end(), [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
  std::vector<Stretch> out;
  for (const Stretch& stretch : intervals) {
    if (out.empty() || stretch.begin > out.back().end) {
      out.push_back(stretch);
    } else {
      out.back().end = std::max(out.back().end, stretch.end);
    }
  }
  return out;
}

/// A bounded solid in a frame of its own: the first coordinate along its length, the second across, the third up,
/// metres. It rests on the plane 0 of the third, and the rectangle that bounds its outline, seen from above, is centred
/// on the origin. Immutable once built; safe to share between threads. No method throws.
///
/// A scene tilts the solid, which turns its vertical into an oblique line of this frame: hence lines, not heights.
class Shape {
 public:
  static constexpr const char* kKind = "shape";

  virtual ~Shape() = default;

  /// The least x at which the line meets the solid, negative if that is behind the line's origin; +infinity if it
  /// misses. Lines point anywhere; but where a scene is touched from above alone they point down. Laws: moving the
  /// origin by a step along the line lessens the answer by that step; no point met lies further out than support()
  /// says.
  virtual double first_intersection(const Line& line) const = 0;

  /// The largest scalar product of a point of the solid with `direction`, which is finite and need not be of unit
  /// length: how far the solid reaches. Laws: convex and positively homogeneous in `direction`; support({0, 0, -1}) is
  /// 0; equal along {1, 0, 0} and {-1, 0, 0}, and along {0, 1, 0} and {0, -1, 0}.
  virtual double support(const Eigen::Vector3d& direction) const = 0;

  /// Height of the upright solid over (s, t) of its own frame; -infinity beside it. Law: what first_intersection() says
  /// of the vertical line there. Overridden where there is a quicker way.
  virtual double top(double s, double t) const { return -first_intersection({{s, t, 0.0}, {0.0, 0.0, -1.0}}); }

  /// Which parts of the line lie in the solid, in their order: of what is hollow those within its walls. As it is here
  /// it is right for what no line leaves and meets again; other shapes override it. Asked only to compare volumes
  /// and to draw sections.
  /// Laws: the first begins at first_intersection(), the last ends where the line the other way round first meets the
  /// solid; whether a point is within does not depend on the line through it.
  virtual std::vector<Stretch> intervals(const Line& line) const {
    const double begin = first_intersection(line);
    const double end = -first_intersection({line.origin, -line.direction});
    return begin < end ? std::vector<Stretch>{{begin, end}} : std::vector<Stretch>{};
  }
};

}  // namespace palpate
