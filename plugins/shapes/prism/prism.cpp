// SPDX-License-Identifier: MIT
#include "shapes/prism/prism.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::shapes {

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

double Prism::first_intersection(const Line& line) const {
  // Interval of the line between the planes of bottom and top.
  Interval between;
  between.clip(line.origin.z(), line.direction.z(), 0.0, height_);
  if (between.empty()) return kInfinity;
  const double enters = between.begin;
  const Point direction{line.direction.x(), line.direction.y()};
  // A nearly vertical line leaves the outline only at heights far beyond the prism.
  if (std::abs(direction[0]) + std::abs(direction[1]) < 1e-12) {
    const double s = line.origin.x() + enters * direction[0];
    const double t = line.origin.y() + enters * direction[1];
    if (top(s, t) == height_) return enters;
    return kInfinity;
  }
  // At each crossing, as seen from above, the line enters or leaves the outline. If the line is inside the outline when
  // it passes the first plane, the intersection is there. Otherwise it is at the first wall between the planes.
  bool inside = false;
  double wall = kInfinity;
  const auto visit = [&](double x) {
    if (x < enters) {
      inside = !inside;
    } else {
      wall = std::min(wall, x);
    }
  };
  const Point origin{line.origin.x(), line.origin.y()};
  visit_crossings(outline_, origin, direction, visit);
  if (!hole_.empty()) visit_crossings(hole_, origin, direction, visit);
  if (inside) return enters;
  if (wall > between.end) return kInfinity;
  return wall;
}

std::vector<LineInterval> Prism::intervals(const Line& line) const {
  Interval between;
  between.clip(line.origin.z(), line.direction.z(), 0.0, height_);
  const Point direction{line.direction.x(), line.direction.y()};
  if (between.empty() || std::abs(direction[0]) + std::abs(direction[1]) < 1e-12) return Shape::intervals(line);
  std::vector<double> crossings;
  const auto visit = [&](double x) { crossings.push_back(x); };
  const Point origin{line.origin.x(), line.origin.y()};
  visit_crossings(outline_, origin, direction, visit);
  if (!hole_.empty()) visit_crossings(hole_, origin, direction, visit);
  std::sort(crossings.begin(), crossings.end());
  std::vector<LineInterval> out;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const LineInterval stretch{std::max(between.begin, crossings[i]), std::min(between.end, crossings[i + 1])};
    if (stretch.begin < stretch.end) out.push_back(stretch);
  }
  return out;
}

double Prism::support(const Eigen::Vector3d& direction) const {
  double best = -kInfinity;
  for (const Point& p : outline_) best = std::max(best, direction.x() * p[0] + direction.y() * p[1]);
  return best + std::max(0.0, direction.z() * height_);
}

}  // namespace palpate::shapes
