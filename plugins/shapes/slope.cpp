// SPDX-License-Identifier: MIT
// Block whose top rises along its length. It is object II of Sun and Min 2021.
#include "solid.hpp"

namespace palpate::shapes {

struct SlopeOptions : Options {
  double length = 0.17;
  double width = 0.06;
  double low = 0.02;
  double high = 0.08;

  void list(Fields& fields) override {
    fields.real(length, Field("length", "size along x, the direction of the rise")
                            .in(Unit::metre)
                            .above(0)
                            .from("Sun and Min 2021: 17 cm"));
    fields.real(width, Field("width", "size along y, perpendicular to the direction of the rise")
                           .in(Unit::metre)
                           .above(0)
                           .from("Sun and Min 2021: 6 cm"));
    fields.real(low,
                Field("low", "height above the desk at the -x end, where the rise begins").in(Unit::metre).at_least(0));
    fields.real(high, Field("high", "height above the desk at the +x end, where the rise ends")
                          .in(Unit::metre)
                          .above(0)
                          .from("Sun and Min 2021: 8 cm"));
  }
};

class Slope final : public Shape {
 public:
  using Options = SlopeOptions;
  Slope(const Options& o, const Context&)
      : length_(o.length), low_(o.low), high_(o.high), half_length_(o.length / 2), half_width_(o.width / 2) {}

  double top(double s, double t) const override {
    if (std::abs(s) > half_length_ || std::abs(t) > half_width_) return -kInfinity;
    return low_ + (high_ - low_) * (s / length_ + 0.5);
  }

  double first_intersection(const Line& line) const override {
    const Eigen::Vector3d& o = line.origin;
    const Eigen::Vector3d& u = line.direction;
    Interval inside;
    inside.clip(-u.z(), o.z());
    inside.clip(o.x(), u.x(), -half_length_, half_length_);
    inside.clip(o.y(), u.y(), -half_width_, half_width_);
    // the inside satisfies z <= middle + rise * s
    const double rise = (high_ - low_) / length_;
    inside.clip(u.z() - rise * u.x(), (low_ + high_) / 2 + rise * o.x() - o.z());
    return inside.first();
  }

  double support(const Eigen::Vector3d& direction) const override {
    const double across = std::abs(direction.y()) * half_width_;
    const double along = direction.x() * half_length_;
    return across +
           std::max(-along + std::max(0.0, direction.z() * low_), along + std::max(0.0, direction.z() * high_));
  }

 private:
  double length_, low_, high_, half_length_, half_width_;
};

PALPATE_PLUGIN(Shape, Slope, "slope", "block with a sloping top (object II of the paper)")

}  // namespace palpate::shapes
