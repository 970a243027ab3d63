// SPDX-License-Identifier: MIT
#include "scene/convex.hpp"

#include "scene/interval.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// The points with sum of weights * (p - centre)^2 <= level: a ball, a cylinder, an ellipsoid or, with a negative
/// weight along z, a double cone.
struct Quadric {
  Vector3d weights;
  Vector3d centre;
  double level;

  /// Where the line is within, of a double cone within the lower half.
  void clip(const Line& line, Interval& interval) const {
    const Vector3d& u = line.direction;
    // From the point of the line that is nearest to the centre, so that nothing cancels for a line from afar.
    const double shift = (centre - line.origin).dot(u);
    const Vector3d from = line.origin + shift * u - centre;
    const Vector3d weighted = weights.cwiseProduct(u);
    const double a = weighted.dot(u);
    const double b = weighted.dot(from);
    const double c = weights.cwiseProduct(from).dot(from) - level;
    // a x^2 + 2 b x + c <= 0
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0 && a >= 0.0) return interval.clear();
    const double q = -(b + std::copysign(std::sqrt(std::max(0.0, discriminant)), b));
    if (q == 0.0) return clip_double_root(a, c, shift, interval);
    const double one = c / q;
    const double other = a == 0.0 ? std::copysign(kInfinity, q) : q / a;
    if (a < 0.0) {
      // A steep line is within both halves of a double cone, above the upper root and below the lower; it points down.
      interval.begin = std::max(interval.begin, std::max(one, other) + shift);
      return;
    }
    interval.begin = std::max(interval.begin, std::min(one, other) + shift);
    interval.end = std::min(interval.end, std::max(one, other) + shift);
  }

 private:
  /// b and the discriminant are 0: a line that runs within or without for ever, one that touches, or a steep one
  /// through the apex of a double cone, below which it is within.
  static void clip_double_root(double a, double c, double shift, Interval& interval) {
    if (a == 0.0 && c > 0.0) interval.clear();
    if (a == 0.0) return;
    interval.begin = std::max(interval.begin, shift);
    if (a > 0.0) interval.end = std::min(interval.end, shift);
  }
};

/// The largest product of a direction with a point of the disk of this radius around the axis, in the plane 0.
double disk_support(const Vector3d& direction, double radius) {
  return radius * std::hypot(direction.x(), direction.y());
}

class Block final : public Shape {
 public:
  explicit Block(const BlockOptions& o) : half_length_(o.length / 2), half_width_(o.width / 2), height_(o.height) {}

  double first_hit(const Line& line) const override {
    Interval inside;
    inside.clip(line.origin.z(), line.direction.z(), 0.0, height_);
    inside.clip(line.origin.x(), line.direction.x(), -half_length_, half_length_);
    inside.clip(line.origin.y(), line.direction.y(), -half_width_, half_width_);
    return inside.first();
  }

  double support(const Vector3d& direction) const override {
    return std::abs(direction.x()) * half_length_ + std::abs(direction.y()) * half_width_ +
           std::max(0.0, direction.z() * height_);
  }

 private:
  double half_length_, half_width_, height_;
};

class Slope final : public Shape {
 public:
  explicit Slope(const SlopeOptions& o)
      : length_(o.length), low_(o.low), high_(o.high), half_length_(o.length / 2), half_width_(o.width / 2) {}

  double top(double s, double t) const override {
    if (std::abs(s) > half_length_ || std::abs(t) > half_width_) return -kInfinity;
    return low_ + (high_ - low_) * (s / length_ + 0.5);
  }

  double first_hit(const Line& line) const override {
    const Vector3d& o = line.origin;
    const Vector3d& u = line.direction;
    Interval inside;
    inside.clip(-u.z(), o.z());
    inside.clip(o.x(), u.x(), -half_length_, half_length_);
    inside.clip(o.y(), u.y(), -half_width_, half_width_);
    // z <= middle + rise * s
    const double rise = (high_ - low_) / length_;
    inside.clip(u.z() - rise * u.x(), (low_ + high_) / 2 + rise * o.x() - o.z());
    return inside.first();
  }

  double support(const Vector3d& direction) const override {
    const double across = std::abs(direction.y()) * half_width_;
    const double along = direction.x() * half_length_;
    return across +
           std::max(-along + std::max(0.0, direction.z() * low_), along + std::max(0.0, direction.z() * high_));
  }

 private:
  double length_, low_, high_, half_length_, half_width_;
};

/// A quadric between the plane 0 and a height.
class Round : public Shape {
 public:
  Round(const Quadric& quadric, double height) : quadric_(quadric), height_(height) {}

  double first_hit(const Line& line) const final {
    Interval inside;
    inside.clip(line.origin.z(), line.direction.z(), 0.0, height_);
    quadric_.clip(line, inside);
    return inside.first();
  }

 protected:
  Quadric quadric_;
  double height_;
};

class Dome final : public Round {
 public:
  explicit Dome(const DomeOptions& o) : Dome(o, (o.diameter * o.diameter / 4 + o.height * o.height) / (2 * o.height)) {}

  double support(const Vector3d& direction) const override {
    // Where the ball reaches furthest at a point below the plane 0, the cap does so at its rim.
    const double length = direction.norm();
    const double centre = height_ - ball_;
    if (centre * length + ball_ * direction.z() < 0.0) return disk_support(direction, rim_);
    return centre * direction.z() + ball_ * length;
  }

 private:
  Dome(const DomeOptions& o, double ball)
      : Round({{1, 1, 1}, {0, 0, o.height - ball}, ball * ball}, o.height), rim_(o.diameter / 2), ball_(ball) {}

  double rim_, ball_;
};

class Cylinder final : public Round {
 public:
  explicit Cylinder(const CylinderOptions& o)
      : Round({{1, 1, 0}, {0, 0, 0}, o.diameter * o.diameter / 4}, o.height), radius_(o.diameter / 2) {}

  double support(const Vector3d& direction) const override {
    return disk_support(direction, radius_) + std::max(0.0, direction.z() * height_);
  }

 private:
  double radius_;
};

class Cone final : public Round {
 public:
  explicit Cone(const ConeOptions& o)
      : Round({{1, 1, -square(o.diameter / (2 * o.height))}, {0, 0, o.height}, 0.0}, o.height),
        radius_(o.diameter / 2) {}

  double support(const Vector3d& direction) const override {
    return std::max(disk_support(direction, radius_), direction.z() * height_);
  }

 private:
  static double square(double x) { return x * x; }

  double radius_;
};

class Ellipsoid final : public Round {
 public:
  explicit Ellipsoid(const EllipsoidOptions& o)
      : Round({{4 / (o.length * o.length), 4 / (o.width * o.width), 4 / (o.height * o.height)},
               {0, 0, o.height / 2},
               1.0},
              o.height),
        half_(o.length / 2, o.width / 2, o.height / 2) {}

  double support(const Vector3d& direction) const override {
    return direction.z() * half_.z() + direction.cwiseProduct(half_).norm();
  }

 private:
  Vector3d half_;
};

class Ring final : public Shape {
 public:
  explicit Ring(const RingOptions& o)
      : outer_{{1, 1, 0}, {0, 0, 0}, o.outer * o.outer / 4},
        inner_{{1, 1, 0}, {0, 0, 0}, o.inner * o.inner / 4},
        radius_(o.outer / 2),
        height_(o.height) {}

  double first_hit(const Line& line) const override {
    Interval solid;
    solid.clip(line.origin.z(), line.direction.z(), 0.0, height_);
    outer_.clip(line, solid);
    Interval hole;
    inner_.clip(line, hole);
    // Through the hole a line goes on to the wall behind it, or to the desk.
    if (!solid.empty() && solid.begin > hole.begin) solid.begin = std::max(solid.begin, hole.end);
    return solid.first();
  }

  double support(const Vector3d& direction) const override {
    return disk_support(direction, radius_) + std::max(0.0, direction.z() * height_);
  }

 private:
  Quadric outer_, inner_;
  double radius_, height_;
};

}  // namespace

std::unique_ptr<const Shape> make_block(const BlockOptions& options) { return std::make_unique<Block>(options); }
std::unique_ptr<const Shape> make_slope(const SlopeOptions& options) { return std::make_unique<Slope>(options); }
std::unique_ptr<const Shape> make_dome(const DomeOptions& options) { return std::make_unique<Dome>(options); }
std::unique_ptr<const Shape> make_cylinder(const CylinderOptions& options) {
  return std::make_unique<Cylinder>(options);
}
std::unique_ptr<const Shape> make_cone(const ConeOptions& options) { return std::make_unique<Cone>(options); }
std::unique_ptr<const Shape> make_ellipsoid(const EllipsoidOptions& options) {
  return std::make_unique<Ellipsoid>(options);
}
std::unique_ptr<const Shape> make_ring(const RingOptions& options) { return std::make_unique<Ring>(options); }

}  // namespace palpate
