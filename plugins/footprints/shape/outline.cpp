// SPDX-License-Identifier: MIT
#include "outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::footprints {

Region::Region(const Outline& outline)
    : x_(outline.x),
      y_(outline.y),
      cosine_(std::cos(outline.angle)),
      sine_(std::sin(outline.angle)),
      a_(outline.a),
      b_(outline.b),
      per_a_(1.0 / outline.a),
      per_b_(1.0 / outline.b),
      ellipse_(outline.family == Outline::Family::ellipse) {
  if (ellipse_) {
    reach_x_ = std::hypot(cosine_ * a_, sine_ * b_);
    reach_y_ = std::hypot(sine_ * a_, cosine_ * b_);
  } else {
    reach_x_ = std::abs(cosine_) * a_ + std::abs(sine_) * b_;
    reach_y_ = std::abs(sine_) * a_ + std::abs(cosine_) * b_;
  }
}

std::pair<double, double> Region::cut(double y) const {
  const double dy = y - y_;
  if (ellipse_) {
    // (u, v) along the cut is linear in x: a quadratic whose middle and half width follow from the reach.
    const double rest = 1.0 - dy * dy / (reach_y_ * reach_y_);
    if (rest < 0.0) return {1.0, 0.0};
    const double middle = x_ + dy * cosine_ * sine_ * (a_ * a_ - b_ * b_) / (reach_y_ * reach_y_);
    const double half = a_ * b_ / reach_y_ * std::sqrt(rest);
    return {middle - half, middle + half};
  }
  double low = -std::numeric_limits<double>::infinity();
  double high = -low;
  // |along * dx + across * dy| <= side, for both pairs of sides.
  const auto clip = [&](double along, double across, double side) {
    if (std::abs(along) < 1e-12) {
      if (std::abs(across * dy) > side) high = -std::numeric_limits<double>::infinity();
      return;
    }
    const double middle = -across * dy / along;
    const double half = side / std::abs(along);
    low = std::max(low, middle - half);
    high = std::min(high, middle + half);
  };
  clip(cosine_, sine_, a_);
  clip(-sine_, cosine_, b_);
  return {x_ + low, x_ + high};
}

}  // namespace palpate::footprints
