// SPDX-License-Identifier: MIT
#include "prism/prism.hpp"

#include <algorithm>
#include <string>

namespace palpate::shapes {
namespace {

double cross(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool within_box(const Point& a, const Point& b, const Point& p) {
  return p[0] >= std::min(a[0], b[0]) && p[0] <= std::max(a[0], b[0]) && p[1] >= std::min(a[1], b[1]) &&
         p[1] <= std::max(a[1], b[1]);
}

/// Returns whether two segments have a common point.
bool intersect(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double c_side = cross(a, b, c);
  const double d_side = cross(a, b, d);
  const double a_side = cross(c, d, a);
  const double b_side = cross(c, d, b);
  const auto apart = [](double one, double other) { return one != 0 && other != 0 && (one > 0) != (other > 0); };
  if (apart(a_side, b_side) && apart(c_side, d_side)) return true;
  return (c_side == 0 && within_box(a, b, c)) || (d_side == 0 && within_box(a, b, d)) ||
         (a_side == 0 && within_box(c, d, a)) || (b_side == 0 && within_box(c, d, b));
}

/// Returns whether edge `i` turns back at its end and overlaps the next edge.
bool folds(const Outline& outline, std::size_t i) {
  const Point& a = outline[i];
  const Point& b = next(outline, i);
  const Point& c = next(outline, (i + 1) % outline.size());
  return cross(a, b, c) == 0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0;
}

/// Returns the number of a corner or an edge for messages, which count from 1.
std::string number(std::size_t i) { return std::to_string(i + 1); }

/// Returns an error text if `outline` cannot be the outline of a solid, else "". The possible errors are too few
/// points, crossing edges, and no area.
std::string outline_error(const Outline& outline) {
  constexpr std::size_t kMostPoints = 2000;
  const std::size_t n = outline.size();
  if (n < 3) return "needs three points or more";
  if (n > kMostPoints)
    return "has " + std::to_string(n) + " points, at most " + std::to_string(kMostPoints) + " are allowed";
  for (std::size_t i = 0; i < n; ++i) {
    if (outline[i] == next(outline, i))
      return "points " + number(i) + " and " + number((i + 1) % n) + " are equal; the outline closes by itself";
    if (folds(outline, i)) return "folds back at point " + number((i + 1) % n);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;  // the first and the last edge are neighbours
      if (intersect(outline[i], next(outline, i), outline[j], next(outline, j)))
        return "edge " + number(i) + " meets edge " + number(j);
    }
  }
  return {};
}

/// Returns an error text if `hole` is not inside `outline`, else "". Both must be valid outlines.
std::string hole_error(const Outline& outline, const Outline& hole) {
  for (std::size_t i = 0; i < hole.size(); ++i) {
    for (std::size_t j = 0; j < outline.size(); ++j) {
      if (intersect(hole[i], next(hole, i), outline[j], next(outline, j)))
        return "its edge " + number(i) + " meets edge " + number(j) + " of the outline";
    }
  }
  return contains(outline, hole.front()) ? "" : "lies outside the outline";
}

}  // namespace

struct PolygonOptions : Options {
  Outline outline;
  Outline hole;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.table(
        outline,
        Field("outline",
              "x, y of the corners of the outline, in order. The rectangle around the corners is centred at `at`")
            .in(Unit::metre)
            .needed());
    const std::string wrong = outline_error(outline);
    fields.require(wrong.empty(), "outline", wrong);
    fields.table(
        hole,
        Field("hole", "x, y of the corners of a hole within the outline, in order; [] for no hole").in(Unit::metre));
    if (wrong.empty() && !hole.empty()) {
      std::string wrong_hole = outline_error(hole);
      if (wrong_hole.empty()) wrong_hole = hole_error(outline, hole);
      fields.require(wrong_hole.empty(), "hole", wrong_hole);
    }
    list_height(height, fields);
  }
};

struct Polygon final : Prism {
  using Options = PolygonOptions;
  Polygon(const Options& o, const Context&) : Prism(o.outline, o.hole, o.height) {}
};

PALPATE_PLUGIN(Shape, Polygon, "polygon", "prism over any polygon")

}  // namespace palpate::shapes
