// SPDX-License-Identifier: MIT
#include "solid.hpp"

namespace palpate::shapes {

struct CylinderOptions : RoundOptions {
  CylinderOptions() : RoundOptions(0.08, 0.06) {}
};

class Cylinder final : public QuadricSolid {
 public:
  using Options = CylinderOptions;
  Cylinder(const Options& o, const Context&)
      : QuadricSolid({{1, 1, 0}, {0, 0, 0}, o.diameter * o.diameter / 4}, o.height), radius_(o.diameter / 2) {}

  double support(const Vector3d& direction) const override {
    return disk_support(direction, radius_) + std::max(0.0, direction.z() * height_);
  }

 private:
  double radius_;
};

PALPATE_PLUGIN(Shape, Cylinder, "cylinder", "standing cylinder")

}  // namespace palpate::shapes
