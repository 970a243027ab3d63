// SPDX-License-Identifier: MIT
#include "outline.hpp"

#include <palpate/error.hpp>

#include <tuple>

namespace palpate::footprints {
namespace {

/// Of the ordered logarithms of two half axes up to `longest`, and a direction, none of which is preferred.
double even_density(double shortest, double longest) {
  const double range = std::log(longest / shortest);
  return 2.0 / (range * range * kPi);
}

}  // namespace

OutlinePrior::OutlinePrior(const Settings& settings) : settings_(settings) {
  const Area& area = settings_.area;
  // What is longer than the diagonal never fits.
  longest_ = 0.5 * std::min(settings_.largest, std::hypot(area.width, area.depth));
  // Which share of the forms that keep no bounds fits: summed up over a grid, fine enough for a thousandth.
  constexpr int kAxes = 48;
  constexpr int kTurns = 32;
  const double shortest = 0.5 * settings_.smallest;
  const auto half_axis = [&](int i) { return shortest * std::pow(longest_ / shortest, (i + 0.5) / kAxes); };
  std::array<double, kAxes> halves{};
  for (int i = 0; i < kAxes; ++i) halves[static_cast<std::size_t>(i)] = half_axis(i);
  for (int turn = 0; turn < kTurns; ++turn) {
    Form form;
    form.turn(kPi * (turn + 0.5) / kTurns);
    for (const Form::Family family : {Form::Family::box, Form::Family::ellipse}) {
      form.family = family;
      const double share = this->family(form);
      for (const double a : halves) {
        for (const double b : halves) {
          if (b > a) break;
          form.a = a;
          form.b = b;
          if (fits(form)) form_ += (b == a ? 1.0 : 2.0) * share;
        }
      }
    }
  }
  form_ = longest_ > shortest ? form_ / (kAxes * kAxes * kTurns) : 0.0;
  if (!(form_ > 1e-5)) {
    throw Error("footprint", "hardly any outline of this prior fits into the area",
                "make smallest and largest smaller");
  }
  form_ = even_density(shortest, longest_) / form_;
}

Form OutlinePrior::draw_form(double longest, Random& random) const {
  const double shortest = 0.5 * settings_.smallest;
  const auto half_axis = [&] { return shortest * std::pow(longest / shortest, random.uniform()); };
  Form out;
  out.family = random.uniform() < settings_.ellipses ? Form::Family::ellipse : Form::Family::box;
  std::tie(out.b, out.a) = std::minmax({half_axis(), half_axis()});
  out.turn(kPi * random.uniform());
  return out;
}

bool OutlinePrior::in_bounds(const Form& form) const {
  return 2.0 * form.b >= settings_.smallest && form.a <= longest_ && form.a <= settings_.most_slender * form.b;
}

bool OutlinePrior::fits(const Form& form) const {
  return in_bounds(form) && 2.0 * form.reach_x() < settings_.area.width && 2.0 * form.reach_y() < settings_.area.depth;
}

Piece OutlinePrior::draw_piece(Random& random) const {
  // Drawn until it fits: that is what the prior says.
  Piece out;
  do {
    out.form = draw_form(longest_, random);
  } while (!fits(out.form));
  const double reach_x = out.form.reach_x();
  const double reach_y = out.form.reach_y();
  out.form.x = reach_x + (settings_.area.width - 2.0 * reach_x) * random.uniform();
  out.form.y = reach_y + (settings_.area.depth - 2.0 * reach_y) * random.uniform();
  out.density = density(out);
  return out;
}

Form OutlinePrior::draw_hole(const Form& form, Random& random) const {
  Form out = draw_form(form.a, random);
  double u, v;
  do {
    u = 2.0 * random.uniform() - 1.0;
    v = 2.0 * random.uniform() - 1.0;
  } while (form.family == Form::Family::ellipse && u * u + v * v > 1.0);
  out.x = form.x + form.cosine * u * form.a - form.sine * v * form.b;
  out.y = form.y + form.sine * u * form.a + form.cosine * v * form.b;
  return out;
}

Piece OutlinePrior::draw_piece_or_hollow(Random& random) const {
  Piece out = draw_piece(random);
  if (random.uniform() >= whole(out.form)) {
    out.hole = draw_hole(out.form, random);
    out.hollow = true;
    out.density = density(out);
  }
  return out;
}

Outline OutlinePrior::draw(Random& random) const {
  for (;;) {
    Outline out;
    double time = -std::log(1.0 - random.uniform());
    for (; time < settings_.expected && out.size() < settings_.most; time -= std::log(1.0 - random.uniform()))
      out.add(draw_piece_or_hollow(random));
    if (time >= settings_.expected) return out;
  }
}

double OutlinePrior::family(const Form& form) const {
  return form.family == Form::Family::ellipse ? settings_.ellipses : 1.0 - settings_.ellipses;
}

double OutlinePrior::centre_density(const Form& form) const {
  if (!in_bounds(form)) return 0.0;
  const double reach_x = form.reach_x();
  const double reach_y = form.reach_y();
  const double width = settings_.area.width;
  const double depth = settings_.area.depth;
  if (!(2.0 * reach_x < width && 2.0 * reach_y < depth)) return 0.0;
  if (form.x < reach_x || form.x + reach_x > width || form.y < reach_y || form.y + reach_y > depth) return 0.0;
  return 1.0 / ((width - 2.0 * reach_x) * (depth - 2.0 * reach_y));
}

double OutlinePrior::hole_centre_density(const Form& form, const Form& hole) const {
  if (2.0 * hole.b < settings_.smallest || hole.a > form.a) return 0.0;
  return form.contains(hole.x, hole.y) ? 1.0 / form.extent() : 0.0;
}

double OutlinePrior::density(const Piece& piece) const {
  const double of_form = centre_density(piece.form) * family(piece.form) * form_;
  // Nothing can be taken from a piece that is smaller.
  if (!piece.hollow) return of_form * whole(piece.form);
  const double hollow = 1.0 - whole(piece.form);
  if (of_form <= 0.0 || hollow <= 0.0) return 0.0;
  return of_form * hollow * hole_centre_density(piece.form, piece.hole) * family(piece.hole) *
         even_density(0.5 * settings_.smallest, piece.form.a);
}

}  // namespace palpate::footprints
