// SPDX-License-Identifier: MIT
// The form of an object, apart from where it stands. The scene turns, tilts and places it.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

namespace palpate {

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
  virtual double first_hit(const Line& line) const = 0;

  /// The largest scalar product of a point of the solid with `direction`, which is finite and need not be of unit
  /// length: how far the solid reaches. Laws: convex and positively homogeneous in `direction`; support({0, 0, -1}) is
  /// 0; equal along {1, 0, 0} and {-1, 0, 0}, and along {0, 1, 0} and {0, -1, 0}.
  virtual double support(const Eigen::Vector3d& direction) const = 0;

  /// Height of the upright solid over (s, t) of its own frame; -infinity beside it. Law: what first_hit() says of the
  /// vertical line there. Overridden where there is a quicker way.
  virtual double top(double s, double t) const { return -first_hit({{s, t, 0.0}, {0.0, 0.0, -1.0}}); }
};

}  // namespace palpate
