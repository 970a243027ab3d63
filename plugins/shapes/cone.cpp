// SPDX-License-Identifier: MIT
#include "solid.hpp"

#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

namespace palpate::shapes {

struct ConeOptions : Options {
  double diameter = 0.12;
  double height = 0.08;

  void list(Fields& fields) override {
    fields.real(diameter, Field("diameter", "of the outline").in(Unit::metre).above(0));
    list_height(height, fields);
  }
};

class Cone final : public Round {
 public:
  using Options = ConeOptions;
  Cone(const Options& o, const Context&)
      : Round({{1, 1, -square(o.diameter / (2 * o.height))}, {0, 0, o.height}, 0.0}, o.height),
        radius_(o.diameter / 2) {}

  double support(const Vector3d& direction) const override {
    return std::max(disk_support(direction, radius_), direction.z() * height_);
  }

 private:
  static double square(double x) { return x * x; }

  double radius_;
};

PALPATE_PLUGIN(Shape, Cone, "cone", "cone with its apex up")

}  // namespace palpate::shapes
