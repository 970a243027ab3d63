// SPDX-License-Identifier: MIT
#include "scene/body.hpp"

#include <algorithm>

namespace palpate {

Body::Body(std::shared_ptr<const Shape> shape, double tilt)
    : shape_(std::move(shape)), upright_(tilt == 0.0), tilt_cosine_(math::cos(tilt)), tilt_sine_(math::sin(tilt)) {
  lift_ = shape_->support(untilted(0.0, 0.0, -1.0));
  place(0.0, 0.0, 0.0);
}

void Body::place(double x, double y, double rotation) {
  // Margin for rounding errors; the shape is evaluated only inside the widened bounds.
  constexpr double kMargin = 1e-9;
  x_ = x;
  y_ = y;
  cosine_ = math::cos(rotation);
  sine_ = math::sin(rotation);
  left_ = x - reach(-1.0, 0.0) - kMargin;
  right_ = x + reach(1.0, 0.0) + kMargin;
  low_ = y - reach(0.0, -1.0) - kMargin;
  high_ = y + reach(0.0, 1.0) + kMargin;
}

double Body::height(double x, double y) const {
  if (x < left_ || x > right_ || y < low_ || y > high_) return 0.0;
  const double s = cosine_ * (x - x_) + sine_ * (y - y_);
  const double t = cosine_ * (y - y_) - sine_ * (x - x_);
  if (upright_) return std::max(0.0, shape_->top(s, t));
  // The line straight down that starts at (s, t) at the height of the desk, in the frame of the shape.
  const Line line{untilted(s, t, -lift_), untilted(0.0, 0.0, -1.0)};
  return std::max(0.0, -shape_->first_intersection(line));
}

Line Body::own(const Line& line) const {
  const Eigen::Vector3d from = line.origin - Eigen::Vector3d(x_, y_, lift_);
  const auto turned = [&](const Eigen::Vector3d& v) {
    return untilted(cosine_ * v.x() + sine_ * v.y(), cosine_ * v.y() - sine_ * v.x(), v.z());
  };
  return {turned(from), turned(line.direction)};
}

double Body::first_intersection(const Line& line) const { return shape_->first_intersection(own(line)); }

std::vector<LineInterval> Body::intervals(const Line& line) const { return shape_->intervals(own(line)); }

double Body::highest() const { return shape_->support(untilted(0.0, 0.0, 1.0)) + lift_; }

double Body::reach(double direction_x, double direction_y) const {
  return shape_->support(
      untilted(cosine_ * direction_x + sine_ * direction_y, cosine_ * direction_y - sine_ * direction_x, 0.0));
}

Eigen::Vector3d Body::untilted(double along, double across, double up) const {
  return {tilt_cosine_ * along + tilt_sine_ * up, across, tilt_cosine_ * up - tilt_sine_ * along};
}

}  // namespace palpate
