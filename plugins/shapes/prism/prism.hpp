// SPDX-License-Identifier: MIT
// Prisms over polygons. An outline can be any polygon whose edges do not cross, with at most one hole.
#pragma once

#include "shapes/solid.hpp"

#include <array>
#include <vector>

namespace palpate::shapes {

using Point = std::array<double, 2>;
/// Corners of a polygon in order, clockwise or counter-clockwise. The last edge goes from the last corner to the first
/// one.
using Outline = std::vector<Point>;

/// Returns the corner that follows corner `i`.
inline const Point& next(const Outline& outline, std::size_t i) { return outline[i + 1 == outline.size() ? 0 : i + 1]; }

/// Calls visit(x) for each x at which the line `origin + x * direction` crosses the outline, as seen from above. A line
/// through a corner crosses exactly one of the corner's two edges, or neither. The side of the line on which the corner
/// lies is computed once for both edges.
template <class Visit>
void visit_crossings(const Outline& outline, const Point& origin, const Point& direction, const Visit& visit) {
  const double squared = direction[0] * direction[0] + direction[1] * direction[1];
  const auto side = [&](const Point& p) {
    return direction[0] * (p[1] - origin[1]) - direction[1] * (p[0] - origin[0]);
  };
  double before = side(outline.front());
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point& a = outline[i];
    const Point& b = next(outline, i);
    const double after = side(b);
    if ((before < 0.0) != (after < 0.0)) {
      const double share = before / (before - after);
      const double dx = a[0] + (b[0] - a[0]) * share - origin[0];
      const double dy = a[1] + (b[1] - a[1]) * share - origin[1];
      visit((dx * direction[0] + dy * direction[1]) / squared);
    }
    before = after;
  }
}

bool contains(const Outline& outline, const Point& point);

class Prism : public Shape {
 public:
  /// `hole` may be empty. The bounding rectangle of `outline` is moved so that its centre is the origin.
  Prism(Outline outline, Outline hole, double height);

  double top(double s, double t) const final;
  double first_intersection(const Line& line) const final;
  double support(const Eigen::Vector3d& direction) const final;
  std::vector<LineInterval> intervals(const Line& line) const final;

 private:
  Outline outline_, hole_;
  double height_;
};

/// Options of the shapes L and T, which consist of two bars of equal thickness.
struct BarsOptions : Options {
  double length = 0.14;
  double width = 0.1;
  double thickness = 0.04;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.real(length,
                Field("length", "outer size along the first bar, the object's x axis").in(Unit::metre).above(0));
    fields.real(
        width,
        Field("width", "outer size perpendicular to the first bar, the object's y axis").in(Unit::metre).above(0));
    fields.real(thickness, Field("thickness", "thickness of both bars, seen from above").in(Unit::metre).above(0));
    list_height(height, fields);
    fields.require(thickness < length && thickness < width, "thickness",
                   "is not less than length and width, which leaves no second bar");
  }
};

}  // namespace palpate::shapes
