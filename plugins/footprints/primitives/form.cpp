// SPDX-License-Identifier: MIT
#include "form.hpp"

#include <limits>

namespace palpate::footprints {

double Form::extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

Cuts::Cuts(const Form& piece) : family(piece.family), x(piece.x), y(piece.y), reach(piece.reach_y()) {
  if (family == Form::Family::ellipse) {
    // (u, v) along the cut is linear in x: a quadratic whose middle and half width follow from the reach.
    slope[0] = piece.cosine * piece.sine * (piece.a * piece.a - piece.b * piece.b) / (reach * reach);
    half[0] = piece.a * piece.b / reach;
    return;
  }
  // |along * dx + across * dy| <= side; sides that run along x are left to the reach.
  const auto sides = [this](int pair, double along, double across, double side) {
    const bool runs_along = std::abs(along) < 1e-12;
    slope[pair] = runs_along ? 0.0 : -across / along;
    half[pair] = runs_along ? std::numeric_limits<double>::infinity() : side / std::abs(along);
  };
  sides(0, piece.cosine, piece.sine, piece.a);
  sides(1, -piece.sine, piece.cosine, piece.b);
}

void Form::order_axes() {
  if (b <= a) return;
  std::swap(a, b);
  std::tie(cosine, sine) = std::pair(-sine, cosine);
}

bool no_line_between(const Form& one, const Form& other) {
  const double dx = other.x - one.x;
  const double dy = other.y - one.y;
  // The way from centre to centre along the axes of both, and the axes of one along those of the other.
  const double u = one.cosine * dx + one.sine * dy;
  const double v = one.cosine * dy - one.sine * dx;
  const double other_u = other.cosine * dx + other.sine * dy;
  const double other_v = other.cosine * dy - other.sine * dx;
  if (dx * dx + dy * dy > one.reach(one.a * u, one.b * v) + other.reach(other.a * other_u, other.b * other_v))
    return false;
  const double c = one.cosine * other.cosine + one.sine * other.sine;
  const double s = one.cosine * other.sine - one.sine * other.cosine;
  return std::abs(u) <= one.a + other.reach(other.a * c, other.b * s) &&
         std::abs(v) <= one.b + other.reach(other.a * s, other.b * c) &&
         std::abs(other_u) <= other.a + one.reach(one.a * c, one.b * s) &&
         std::abs(other_v) <= other.b + one.reach(one.a * s, one.b * c);
}

}  // namespace palpate::footprints
