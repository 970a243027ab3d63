// SPDX-License-Identifier: MIT
// Cylinder with a cylindrical hole. It is not convex, but the intersections are computed from the intervals of both
// cylinders.
#include "solid.hpp"

namespace palpate::shapes {

struct RingOptions : Options {
  double outer = 0.14;
  double inner = 0.06;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.real(outer, Field("outer", "outer diameter, seen from above").in(Unit::metre).above(0));
    fields.real(inner, Field("inner", "diameter of the hole").in(Unit::metre).above(0));
    list_height(height, fields);
    fields.require(inner < outer, "inner", "is not less than the outer diameter");
  }
};

class Ring final : public QuadricSolid {
 public:
  using Options = RingOptions;
  Ring(const Options& o, const Context&)
      : QuadricSolid({{1, 1, 0}, {0, 0, 0}, o.outer * o.outer / 4}, o.height),
        inner_{{1, 1, 0}, {0, 0, 0}, o.inner * o.inner / 4},
        radius_(o.outer / 2) {}

  double first_intersection(const Line& line) const override {
    Interval solid = inside(line);
    Interval hole;
    inner_.clip(line, hole);
    // A line that enters the hole continues to the opposite wall, or to the desk.
    if (!solid.empty() && solid.begin > hole.begin) solid.begin = std::max(solid.begin, hole.end);
    return solid.first();
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    const Interval solid = inside(line);
    Interval hole;
    inner_.clip(line, hole);
    std::vector<LineInterval> out;
    if (hole.empty()) hole.begin = hole.end = kInfinity;
    const LineInterval before{solid.begin, std::min(solid.end, hole.begin)};
    const LineInterval behind{std::max(solid.begin, hole.end), solid.end};
    if (before.begin < before.end) out.push_back(before);
    if (behind.begin < behind.end) out.push_back(behind);
    return out;
  }

  double support(const Vector3d& direction) const override {
    return disk_support(direction, radius_) + std::max(0.0, direction.z() * height_);
  }

 private:
  Quadric inner_;
  double radius_;
};

PALPATE_PLUGIN(Shape, Ring, "ring", "cylinder with a round hole")

}  // namespace palpate::shapes
