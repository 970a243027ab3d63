// SPDX-License-Identifier: MIT
#include "scene/prism.hpp"

#include "scene/interval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Point = std::array<double, 2>;

double cross(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

const Point& next(const Outline& outline, std::size_t i) { return outline[i + 1 == outline.size() ? 0 : i + 1]; }

/// Calls visit(x) for every x at which the line `origin + x * direction`, seen from above, crosses the outline. A line
/// through a corner crosses either of its edges or none: the side of a corner is computed once for both.
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

bool contains(const Outline& outline, const Point& point) {
  bool inside = false;
  visit_crossings(outline, point, {1.0, 0.0}, [&](double x) { inside = inside != (x < 0.0); });
  return inside;
}

class Prism final : public Shape {
 public:
  /// `hole` may be empty. The bounding rectangle of `outline` is moved to the origin.
  Prism(Outline outline, Outline hole, double height)
      : outline_(std::move(outline)), hole_(std::move(hole)), height_(height) {
    const auto [left, right] = std::minmax_element(outline_.begin(), outline_.end());
    const auto [low, high] = std::minmax_element(outline_.begin(), outline_.end(),
                                                 [](const Point& a, const Point& b) { return a[1] < b[1]; });
    const Point centre{((*left)[0] + (*right)[0]) / 2, ((*low)[1] + (*high)[1]) / 2};
    for (Outline* loop : {&outline_, &hole_}) {
      for (Point& point : *loop) point = {point[0] - centre[0], point[1] - centre[1]};
    }
  }

  double top(double s, double t) const override {
    const Point point{s, t};
    return contains(outline_, point) && !(!hole_.empty() && contains(hole_, point)) ? height_ : -kInfinity;
  }

  double first_hit(const Line& line) const override {
    const double upper = (height_ - line.origin.z()) / line.direction.z();
    const double lower = -line.origin.z() / line.direction.z();
    const Point direction{line.direction.x(), line.direction.y()};
    // Far beyond the outline before a line so near to the vertical has passed the height.
    if (std::abs(direction[0]) + std::abs(direction[1]) < 1e-12) {
      const double s = line.origin.x() + upper * direction[0];
      const double t = line.origin.y() + upper * direction[1];
      return top(s, t) == height_ ? upper : kInfinity;
    }
    // Seen from above, each crossing leads in or out. In at the height of the top: that is the hit; else the first wall
    // before the line is through the plane 0.
    bool inside = false;
    double wall = kInfinity;
    const auto visit = [&](double x) {
      if (x < upper) {
        inside = !inside;
      } else {
        wall = std::min(wall, x);
      }
    };
    const Point origin{line.origin.x(), line.origin.y()};
    visit_crossings(outline_, origin, direction, visit);
    if (!hole_.empty()) visit_crossings(hole_, origin, direction, visit);
    if (inside) return upper;
    return wall <= lower ? wall : kInfinity;
  }

  double support(const Eigen::Vector3d& direction) const override {
    double best = -kInfinity;
    for (const Point& p : outline_) best = std::max(best, direction.x() * p[0] + direction.y() * p[1]);
    return best + std::max(0.0, direction.z() * height_);
  }

 private:
  Outline outline_, hole_;
  double height_;
};

bool within_box(const Point& a, const Point& b, const Point& p) {
  return p[0] >= std::min(a[0], b[0]) && p[0] <= std::max(a[0], b[0]) && p[1] >= std::min(a[1], b[1]) &&
         p[1] <= std::max(a[1], b[1]);
}

/// Whether two segments have a point in common.
bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double c_side = cross(a, b, c);
  const double d_side = cross(a, b, d);
  const double a_side = cross(c, d, a);
  const double b_side = cross(c, d, b);
  if (((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0)) && c_side != 0 && d_side != 0 && a_side != 0 &&
      b_side != 0) {
    return true;
  }
  return (c_side == 0 && within_box(a, b, c)) || (d_side == 0 && within_box(a, b, d)) ||
         (a_side == 0 && within_box(c, d, a)) || (b_side == 0 && within_box(c, d, b));
}

/// Edge `i` folds back onto itself at its end.
bool folds(const Outline& outline, std::size_t i) {
  const Point& a = outline[i];
  const Point& b = next(outline, i);
  const Point& c = next(outline, (i + 1) % outline.size());
  return cross(a, b, c) == 0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0;
}

}  // namespace

std::string trouble_of_outline(const Outline& outline) {
  constexpr std::size_t kMostPoints = 2000;
  const std::size_t n = outline.size();
  if (n < 3) return "needs three points or more";
  if (n > kMostPoints) return fmt::format("has {} points, at most {} are allowed", n, kMostPoints);
  for (std::size_t i = 0; i < n; ++i) {
    if (outline[i] == next(outline, i)) {
      return fmt::format("points {} and {} are the same; it closes by itself", i + 1, (i + 1) % n + 1);
    }
    if (folds(outline, i)) return fmt::format("folds back at point {}", (i + 1) % n + 1);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;  // neighbours
      if (meet(outline[i], next(outline, i), outline[j], next(outline, j))) {
        return fmt::format("edge {} meets edge {}", i + 1, j + 1);
      }
    }
  }
  return {};
}

std::string trouble_of_hole(const Outline& outline, const Outline& hole) {
  for (std::size_t i = 0; i < hole.size(); ++i) {
    for (std::size_t j = 0; j < outline.size(); ++j) {
      if (meet(hole[i], next(hole, i), outline[j], next(outline, j))) {
        return fmt::format("its edge {} meets edge {} of the outline", i + 1, j + 1);
      }
    }
  }
  return contains(outline, hole.front()) ? "" : "lies outside the outline";
}

std::unique_ptr<const Shape> make_polygon(const PolygonOptions& options) {
  return std::make_unique<Prism>(options.outline, options.hole, options.height);
}

std::unique_ptr<const Shape> make_l(const BarsOptions& o) {
  const double b = o.thickness;
  return std::make_unique<Prism>(Outline{{0, 0}, {o.length, 0}, {o.length, b}, {b, b}, {b, o.width}, {0, o.width}},
                                 Outline{}, o.height);
}

std::unique_ptr<const Shape> make_t(const BarsOptions& o) {
  const double left = (o.length - o.thickness) / 2;
  const double right = (o.length + o.thickness) / 2;
  const double under = o.width - o.thickness;
  return std::make_unique<Prism>(Outline{{left, 0},
                                         {right, 0},
                                         {right, under},
                                         {o.length, under},
                                         {o.length, o.width},
                                         {0, o.width},
                                         {0, under},
                                         {left, under}},
                                 Outline{}, o.height);
}

}  // namespace palpate
