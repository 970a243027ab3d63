// SPDX-License-Identifier: MIT
// Cap of a sphere, at most a hemisphere.
#include "solid.hpp"

namespace palpate::shapes {

struct DomeOptions : RoundOptions {
  DomeOptions() : RoundOptions(0.12, 0.04) {}

  void list(Fields& fields) override {
    RoundOptions::list(fields);
    fields.require(height <= diameter / 2, "height", "is more than half the diameter, the height of a half ball");
  }
};

class Dome final : public QuadricSolid {
 public:
  using Options = DomeOptions;
  Dome(const Options& o, const Context&)
      : Dome(o, (o.diameter * o.diameter / 4 + o.height * o.height) / (2 * o.height)) {}

  double support(const Vector3d& direction) const override {
    // If the support point of the sphere is below the plane z = 0, the support point of the cap is on the cap's rim.
    const double length = direction.norm();
    const double centre = height_ - ball_;
    if (centre * length + ball_ * direction.z() < 0.0) return disk_support(direction, rim_);
    return centre * direction.z() + ball_ * length;
  }

 private:
  Dome(const DomeOptions& o, double ball)
      : QuadricSolid({{1, 1, 1}, {0, 0, o.height - ball}, ball * ball}, o.height), rim_(o.diameter / 2), ball_(ball) {}

  double rim_, ball_;
};

PALPATE_PLUGIN(Shape, Dome, "dome", "cap of a sphere")

}  // namespace palpate::shapes
