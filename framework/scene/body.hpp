// SPDX-License-Identifier: MIT
// A shape with its pose on the desk: tilted, set down, rotated and moved.
#pragma once

#include <palpate/math.hpp>
#include <palpate/shape.hpp>

#include <memory>
#include <vector>

namespace palpate {

/// Coordinates are relative to the desk: x and y in the frame of the area, z above the desk, metres.
class Body {
 public:
  /// Tilts the shape by `tilt` (radians) and sets it down, so that its lowest point touches the desk. The body is at
  /// the origin, with the rotation 0.
  Body(std::shared_ptr<const Shape> shape, double tilt);

  /// Rotates the body by `rotation` (radians) about the vertical axis, and moves the origin of its frame to (x, y).
  void place(double x, double y, double rotation);

  /// Returns the height above the desk at (x, y); 0 outside of the body. Points on the outline count as inside.
  double height(double x, double y) const;

  /// Returns the distance from the line's origin to its first intersection with the body, metres; +infinity if there is
  /// none.
  double first_intersection(const Line& line) const;

  /// Returns the intervals of a line inside the body, in ascending order.
  std::vector<LineInterval> intervals(const Line& line) const;

  /// Returns the height of the highest point above the desk.
  double highest() const;

  /// Returns how far the body extends from its position in a horizontal direction, metres. The direction is a unit
  /// vector.
  double reach(double direction_x, double direction_y) const;

  double x() const { return x_; }
  double y() const { return y_; }
  double rotation() const { return math::atan2(sine_, cosine_); }

 private:
  /// Transforms a line into the frame of the shape.
  Line own(const Line& line) const;
  /// Transforms a vector from the body's frame, whose z axis is vertical, into the frame of the shape.
  Eigen::Vector3d untilted(double along, double across, double up) const;

  std::shared_ptr<const Shape> shape_;
  bool upright_;
  double tilt_cosine_, tilt_sine_;
  double lift_;
  double x_ = 0.0, y_ = 0.0;
  double cosine_ = 1.0, sine_ = 0.0;
  double left_ = 0.0, right_ = 0.0, low_ = 0.0, high_ = 0.0;  ///< bounds of the outline along x and y, slightly widened
};

}  // namespace palpate
