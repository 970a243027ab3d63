// SPDX-License-Identifier: MIT
#include "solid.hpp"

namespace palpate::shapes {

struct ConeOptions : RoundOptions {
  ConeOptions() : RoundOptions(0.12, 0.08) {}
};

class Cone final : public QuadricSolid {
 public:
  using Options = ConeOptions;
  Cone(const Options& o, const Context&)
      : QuadricSolid({{1, 1, -square(o.diameter / (2 * o.height))}, {0, 0, o.height}, 0.0}, o.height),
        radius_(o.diameter / 2) {}

  double support(const Vector3d& direction) const override {
    return std::max(disk_support(direction, radius_), direction.z() * height_);
  }

 private:
  static double square(double x) { return x * x; }

  double radius_;
};

PALPATE_PLUGIN(Shape, Cone, "cone", "upright cone")

}  // namespace palpate::shapes
