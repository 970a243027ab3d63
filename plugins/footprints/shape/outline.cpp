// SPDX-License-Identifier: MIT
#include "outline.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <limits>
#include <tuple>

namespace palpate::footprints {

double Piece::extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

std::pair<double, double> Piece::cut(double py) const { return Cuts(*this).at(py); }

Cuts::Cuts(const Piece& piece) : family_(piece.family), x_(piece.x), y_(piece.y), reach_(piece.reach_y()) {
  if (family_ == Piece::Family::ellipse) {
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

void Piece::order_axes() {
  if (b <= a) return;
  std::swap(a, b);
  std::tie(cosine, sine) = std::pair(-sine, cosine);
}

Piece OutlinePrior::draw_form(double longest, Random& random) const {
  const double shortest = 0.5 * settings_.smallest;
  const auto half_axis = [&] { return shortest * std::pow(longest / shortest, random.uniform()); };
  Piece out;
  out.family = random.uniform() < settings_.ellipses ? Piece::Family::ellipse : Piece::Family::box;
  std::tie(out.b, out.a) = std::minmax({half_axis(), half_axis()});
  out.turn(kPi * random.uniform());
  return out;
}

Piece OutlinePrior::draw_piece(Random& random) const {
  // Drawn until it fits: that is what the prior says. Small ones nearly always fit where any do.
  constexpr int kPatience = 100000;
  const double width = settings_.area.width;
  const double depth = settings_.area.depth;
  // What is longer than the diagonal would never fit, so it need not be drawn.
  const double longest = 0.5 * std::min(settings_.largest, std::hypot(width, depth));
  for (int tries = 0; tries < kPatience; ++tries) {
    Piece out = draw_form(longest, random);
    const double reach_x = out.reach_x();
    const double reach_y = out.reach_y();
    if (out.a > settings_.most_slender * out.b) continue;
    if (2.0 * reach_x >= width || 2.0 * reach_y >= depth) continue;
    out.x = reach_x + (width - 2.0 * reach_x) * random.uniform();
    out.y = reach_y + (depth - 2.0 * reach_y) * random.uniform();
    return out;
  }
  throw Error("footprint", "hardly any outline of this prior fits into the area", "make smallest and largest smaller");
}

Piece OutlinePrior::draw_second(Outline::Kind kind, const Piece& first, Random& random) const {
  if (kind == Outline::Kind::two) return draw_piece(random);
  Piece out = draw_form(first.a, random);
  double u, v;
  do {
    u = 2.0 * random.uniform() - 1.0;
    v = 2.0 * random.uniform() - 1.0;
  } while (first.family == Piece::Family::ellipse && u * u + v * v > 1.0);
  out.x = first.x + first.cosine * u * first.a - first.sine * v * first.b;
  out.y = first.y + first.sine * u * first.a + first.cosine * v * first.b;
  return out;
}

Outline OutlinePrior::draw(Random& random) const {
  for (;;) {
    Outline out;
    const double kind = random.uniform();
    out.first = draw_piece(random);
    if (kind >= settings_.two + settings_.without) return out;
    out.kind = kind < settings_.two ? Outline::Kind::two : Outline::Kind::without;
    // Nothing can be taken from a piece that is smaller.
    if (out.kind == Outline::Kind::without && out.first.a < settings_.smallest) continue;
    out.second = draw_second(out.kind, out.first, random);
    return out;
  }
}

double OutlinePrior::odds(Outline::Kind kind) const {
  if (kind == Outline::Kind::one) return 1.0;
  return (kind == Outline::Kind::two ? settings_.two : settings_.without) / (1.0 - settings_.two - settings_.without);
}

double OutlinePrior::family(const Piece& piece) const {
  return piece.family == Piece::Family::ellipse ? settings_.ellipses : 1.0 - settings_.ellipses;
}

double OutlinePrior::centre_density(const Piece& piece) const {
  if (2.0 * piece.b < settings_.smallest || 2.0 * piece.a > settings_.largest) return 0.0;
  if (piece.a > settings_.most_slender * piece.b) return 0.0;
  const double reach_x = piece.reach_x();
  const double reach_y = piece.reach_y();
  const double width = settings_.area.width;
  const double depth = settings_.area.depth;
  if (piece.x < reach_x || piece.x + reach_x > width || piece.y < reach_y || piece.y + reach_y > depth) return 0.0;
  return 1.0 / ((width - 2.0 * reach_x) * (depth - 2.0 * reach_y));
}

double OutlinePrior::second_centre_density(const Outline& outline) const {
  if (outline.kind == Outline::Kind::two) return centre_density(outline.second);
  const Piece& first = outline.first;
  if (first.a < settings_.smallest) return 0.0;  // as in draw()
  if (2.0 * outline.second.b < settings_.smallest || outline.second.a > first.a) return 0.0;
  return first.contains(outline.second.x, outline.second.y) ? 1.0 / first.extent() : 0.0;
}

double OutlinePrior::density(const Outline& outline) const {
  const double first = centre_density(outline.first) * family(outline.first);
  if (outline.kind == Outline::Kind::one || first <= 0.0) return first;
  const double second = second_centre_density(outline) * family(outline.second);
  // Half axes of what is taken away are spread over a range that the first piece gives.
  const double range =
      outline.kind == Outline::Kind::without ? std::log(2.0 * outline.first.a / settings_.smallest) : 1.0;
  return odds(outline.kind) * first * second / (range * range);
}

}  // namespace palpate::footprints
