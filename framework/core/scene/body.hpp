// SPDX-License-Identifier: MIT
// A shape somewhere on the desk: tilted, set down, turned and moved.
#pragma once

#include <palpate/math.hpp>
#include <palpate/shape.hpp>

#include <cmath>
#include <memory>
#include <vector>

namespace palpate {

/// Coordinates relative to the desk: x, y in the frame of the area, z above the desk.
class Body {
 public:
  /// Tilted by `tilt` and set down, so that its lowest point touches the desk; at the origin, not rotated.
  Body(std::shared_ptr<const Shape> shape, double tilt);

  /// Rotates it about the vertical, and moves the origin of its frame over (x, y).
  void place(double x, double y, double rotation);

  /// Height above the desk at (x, y): 0 beside the body; its outline belongs to it.
  double height(double x, double y) const;

  /// Where a line first meets it, metres from the line's origin; +infinity if it does not.
  double first_intersection(const Line& line) const;

  /// Which parts of a line lie in it, in their order.
  std::vector<Stretch> intervals(const Line& line) const;

  /// Of its highest point, above the desk.
  double highest() const;

  /// How far it reaches from its own place in a horizontal direction of unit length.
  double reach(double direction_x, double direction_y) const;

  double x() const { return x_; }
  double y() const { return y_; }
  double rotation() const { return math::atan2(sine_, cosine_); }

 private:
  /// A line in the frame of the shape.
  Line own(const Line& line) const;
  /// A vector of the frame that is not tilted, in that of the shape.
  Eigen::Vector3d untilted(double along, double across, double up) const;

  std::shared_ptr<const Shape> shape_;
  bool upright_;
  double tilt_cosine_, tilt_sine_;
  double lift_;
  double x_ = 0.0, y_ = 0.0;
  double cosine_ = 1.0, sine_ = 0.0;
  double left_ = 0.0, right_ = 0.0, low_ = 0.0, high_ = 0.0;  ///< bounds of its outline, slightly widened
};

}  // namespace palpate
