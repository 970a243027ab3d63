// SPDX-License-Identifier: MIT
#include "outline.hpp"

#include <algorithm>
#include <limits>

namespace palpate::footprints {

double Piece::extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

std::pair<double, double> Piece::cut(double py) const {
  const double dy = py - y;
  if (family == Family::ellipse) {
    // (u, v) along the cut is linear in x: a quadratic whose middle and half width follow from the reach.
    const double reach = reach_y();
    const double rest = 1.0 - dy * dy / (reach * reach);
    if (rest < 0.0) return {1.0, 0.0};
    const double middle = x + dy * cosine * sine * (a * a - b * b) / (reach * reach);
    const double half = a * b / reach * std::sqrt(rest);
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
  clip(cosine, sine, a);
  clip(-sine, cosine, b);
  return {x + low, x + high};
}

void Piece::turn(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double turned = cosine * c - sine * s;
  sine = sine * c + cosine * s;
  cosine = turned;
}

void Piece::order_axes() {
  if (b <= a) return;
  std::swap(a, b);
  const double turned = -sine;
  sine = cosine;
  cosine = turned;
}

}  // namespace palpate::footprints
