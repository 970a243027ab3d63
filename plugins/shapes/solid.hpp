// SPDX-License-Identifier: MIT
// Common part of shapes: options, and the intersection of a line with a convex set. A solid may be bounded by
// half-spaces and a quadric. A line is inside it where it is inside all of them, so the result is the intersection of
// their intervals, exact up to rounding.
#pragma once

#include <palpate/math.hpp>
#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::shapes {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Interval of a line within a convex set. It is empty if begin > end.
struct Interval {
  double begin = -kInfinity;
  double end = kInfinity;

  bool empty() const { return begin > end; }
  /// Returns the begin of the interval. Returns infinity if the interval is empty.
  double first() const {
    if (empty()) return kInfinity;
    return begin;
  }
  void clear() { begin = kInfinity, end = -kInfinity; }

  /// Keeps the part of the interval with slope * x <= room.
  void clip(double slope, double room) {
    if (slope > 0.0) {
      end = std::min(end, room / slope);
    } else if (slope < 0.0) {
      begin = std::max(begin, room / slope);
    } else if (room < 0.0) {
      clear();
    }
  }

  /// Keeps the part of the interval between two parallel planes: low <= origin + slope * x <= high.
  void clip(double origin, double slope, double low, double high) {
    clip(slope, high - origin);
    clip(-slope, origin - low);
  }
};

/// Lists the option `height` for shapes that have a single height.
inline void list_height(double& height, Fields& fields) {
  fields.real(height, Field("height", "height of the top above the desk, without tilt").in(Unit::metre).above(0));
}

/// Options of shapes with a round outline.
struct RoundOptions : Options {
  double diameter, height;
  RoundOptions(double across, double up) : diameter(across), height(up) {}

  void list(Fields& fields) override {
    fields.real(diameter, Field("diameter", "outer diameter, seen from above").in(Unit::metre).above(0));
    list_height(height, fields);
  }
};

/// Options of shapes with length, width and height.
struct ExtentOptions : Options {
  double length, width, height;
  ExtentOptions(double along, double across, double up) : length(along), width(across), height(up) {}

  void list(Fields& fields) override {
    fields.real(length, Field("length", "size along x, before the object is rotated").in(Unit::metre).above(0));
    fields.real(width, Field("width", "size along y, before the object is rotated").in(Unit::metre).above(0));
    list_height(height, fields);
  }
};

using Eigen::Vector3d;

/// All points p with (sum of weights * (p - centre)^2) <= level. This is a sphere, a cylinder or an ellipsoid. With a
/// negative weight along z, it is a double cone.
struct Quadric {
  Vector3d weights;
  Vector3d centre;
  double level;

  /// Clips an interval to the inside of the quadric. If the quadric is a double cone, clips it to the inside of the
  /// lower half.
  void clip(const Line& line, Interval& interval) const {
    const Vector3d& u = line.direction;
    // The computation is relative to the point of the line nearest to the centre, which avoids cancellation for distant
    // lines.
    const double shift = (centre - line.origin).dot(u);
    const Vector3d from = line.origin + shift * u - centre;
    const Vector3d weighted = weights.cwiseProduct(u);
    const double a = weighted.dot(u);
    const double b = weighted.dot(from);
    const double c = weights.cwiseProduct(from).dot(from) - level;
    // the inside satisfies a * x^2 + 2 * b * x + c <= 0
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0 && a >= 0.0) return interval.clear();
    const double q = -(b + std::copysign(std::sqrt(std::max(0.0, discriminant)), b));
    if (q == 0.0) return clip_double_root(a, c, u.z() < 0.0, shift, interval);
    const double one = c / q;
    const double other = a == 0.0 ? std::copysign(kInfinity, q) : q / a;
    if (a < 0.0) {
      // A steep line is inside both halves of a double cone: above the upper root and below the lower root.
      if (u.z() < 0.0) {
        interval.begin = std::max(interval.begin, std::max(one, other) + shift);
      } else {
        interval.end = std::min(interval.end, std::min(one, other) + shift);
      }
      return;
    }
    interval.begin = std::max(interval.begin, std::min(one, other) + shift);
    interval.end = std::min(interval.end, std::max(one, other) + shift);
  }

 private:
  /// Clips an interval if both b and the discriminant are 0. There are three cases. The line is entirely inside or
  /// outside; it touches the quadric; or it is steep and passes through the apex of a double cone. A steep line is
  /// inside below the apex.
  static void clip_double_root(double a, double c, bool down, double shift, Interval& interval) {
    if (a == 0.0 && c > 0.0) interval.clear();
    if (a == 0.0) return;
    if (a > 0.0 || down) interval.begin = std::max(interval.begin, shift);
    if (a > 0.0 || !down) interval.end = std::min(interval.end, shift);
  }
};

/// Returns the largest scalar product of `direction` with a point of a disk. The disk is in the plane z = 0, and its
/// centre is on the z axis.
inline double disk_support(const Vector3d& direction, double radius) {
  return radius * math::hypot(direction.x(), direction.y());
}

/// A quadric that is clipped by the planes z = 0 and z = `height`.
class QuadricSolid : public Shape {
 public:
  QuadricSolid(const Quadric& quadric, double height) : quadric_(quadric), height_(height) {}

  double first_intersection(const Line& line) const override { return inside(line).first(); }

 protected:
  Interval inside(const Line& line) const {
    Interval out;
    out.clip(line.origin.z(), line.direction.z(), 0.0, height_);
    quadric_.clip(line, out);
    return out;
  }

  Quadric quadric_;
  double height_;
};

}  // namespace palpate::shapes
