// SPDX-License-Identifier: MIT
#include "prism.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::shapes {
namespace {

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

}  // namespace

bool contains(const Outline& outline, const Point& point) {
  bool inside = false;
  visit_crossings(outline, point, {1.0, 0.0}, [&](double x) { inside = inside != (x < 0.0); });
  return inside;
}

Prism::Prism(Outline outline, Outline hole, double height)
    : outline_(std::move(outline)), hole_(std::move(hole)), height_(height) {
  const auto [left, right] = std::minmax_element(outline_.begin(), outline_.end());
  const auto [low, high] =
      std::minmax_element(outline_.begin(), outline_.end(), [](const Point& a, const Point& b) { return a[1] < b[1]; });
  const Point centre{((*left)[0] + (*right)[0]) / 2, ((*low)[1] + (*high)[1]) / 2};
  for (Outline* loop : {&outline_, &hole_}) {
    for (Point& point : *loop) point = {point[0] - centre[0], point[1] - centre[1]};
  }
}

double Prism::top(double s, double t) const {
  const Point point{s, t};
  return contains(outline_, point) && !(!hole_.empty() && contains(hole_, point)) ? height_ : -kInfinity;
}

double Prism::first_hit(const Line& line) const {
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

double Prism::support(const Eigen::Vector3d& direction) const {
  double best = -kInfinity;
  for (const Point& p : outline_) best = std::max(best, direction.x() * p[0] + direction.y() * p[1]);
  return best + std::max(0.0, direction.z() * height_);
}

}  // namespace palpate::shapes
