// SPDX-License-Identifier: MIT
#include "form.hpp"

#include <limits>

namespace palpate::footprints {

double Form::extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

std::pair<double, double> Form::cut(double py) const { return Cuts(*this).at(py); }

Cuts::Cuts(const Form& piece) : family_(piece.family), x_(piece.x), y_(piece.y), reach_(piece.reach_y()) {
  if (family_ == Form::Family::ellipse) {
    // (u, v) along the cut is linear in x: a quadratic whose middle and half width follow from the reach.
    slope_[0] = piece.cosine * piece.sine * (piece.a * piece.a - piece.b * piece.b) / (reach_ * reach_);
    half_[0] = piece.a * piece.b / reach_;
    return;
  }
  // |along * dx + across * dy| <= side; sides that run along x are left to the reach.
  const auto sides = [this](int pair, double along, double across, double side) {
    const bool runs_along = std::abs(along) < 1e-12;
    slope_[pair] = runs_along ? 0.0 : -across / along;
    half_[pair] = runs_along ? std::numeric_limits<double>::infinity() : side / std::abs(along);
  };
  sides(0, piece.cosine, piece.sine, piece.a);
  sides(1, -piece.sine, piece.cosine, piece.b);
}

void Form::order_axes() {
  if (b <= a) return;
  std::swap(a, b);
  std::tie(cosine, sine) = std::pair(-sine, cosine);
}

bool meet(const Form& one, const Form& other) {
  const double dx = other.x - one.x;
  const double dy = other.y - one.y;
  const auto apart = [&](double x, double y) {
    return std::abs(dx * x + dy * y) > one.reach_along(x, y) + other.reach_along(x, y);
  };
  // The circles about them, and those in them, tell of most.
  const double square = dx * dx + dy * dy;
  const double within = one.b + other.b;
  if (square <= within * within) return true;
  const double beyond = one.a + other.a;
  if (square > 2.0 * beyond * beyond) return false;
  const double distance = std::sqrt(square);
  if (distance > 0.0 && apart(dx / distance, dy / distance)) return false;
  for (const Form* form : {&one, &other}) {
    if (apart(form->cosine, form->sine) || apart(-form->sine, form->cosine)) return false;
  }
  return true;
}

}  // namespace palpate::footprints
