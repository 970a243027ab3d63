// SPDX-License-Identifier: MIT
#include "solid.hpp"

namespace palpate::shapes {

struct EllipsoidOptions : ExtentOptions {
  EllipsoidOptions() : ExtentOptions(0.14, 0.09, 0.06) {}
};

class Ellipsoid final : public QuadricSolid {
 public:
  using Options = EllipsoidOptions;
  Ellipsoid(const Options& o, const Context&)
      : QuadricSolid({{4 / (o.length * o.length), 4 / (o.width * o.width), 4 / (o.height * o.height)},
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

PALPATE_PLUGIN(Shape, Ellipsoid, "ellipsoid", "whole ellipsoid that rests on the desk")

}  // namespace palpate::shapes
