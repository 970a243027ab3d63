// SPDX-License-Identifier: MIT
#include "outline.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace palpate::footprints {
namespace {

// Shares of a form's axes that a fitted hole takes.
constexpr double kLeastShare = 0.1;
constexpr double kMostShare = 0.9;

/// Half axes of about round ellipses, from `shortest` on over a range of logarithms.
class Round {
 public:
  Round(double shortest, double range) : shortest_(shortest), range_(range), most_(std::min(kMost, 0.5 * range)) {}

  /// `apart` and `size` in [0, 1], even ones for even logarithms.
  void set(Form& form, double apart, double size) const {
    const double by = most_ * apart;
    form.b = shortest_ * math::exp((range_ - by) * size);
    form.a = form.b * math::exp(by);
  }
  double density(const Form& form) const {
    if (form.a > kRatio * form.b) return 0.0;
    const double by = math::log(form.a / form.b);
    return by < most_ ? 1.0 / (most_ * (range_ - by)) : 0.0;
  }

 private:
  static constexpr double kRatio = 1.06;
  static constexpr double kMost = 0.058268908123975775;  // its logarithm
  double shortest_, range_, most_;
};

}  // namespace

void Piece::fit_hole() {
  if (!fitted()) return;
  hole = form;
  if (fit == Fit::concentric) {
    hole.a *= along;
    hole.b *= along;
    return;
  }
  // About the corner: beyond the sides nothing is left of the form, however a touch there is blurred.
  const double u = side_a * form.a;
  const double v = side_b * form.b;
  hole.x += form.cosine * u - form.sine * v;
  hole.y += form.sine * u + form.cosine * v;
  hole.a *= 2.0 * along;
  hole.b *= 2.0 * across;
  hole.order_axes();
}

void Piece::order_axes() {
  if (form.b <= form.a) return;
  form.order_axes();
  if (fit == Fit::corner) std::swap(along, across);
  std::tie(side_a, side_b) = std::pair(side_b, -side_a);
}

OutlinePrior::OutlinePrior(const Settings& settings) : settings_(settings) {
  const Area& area = settings_.area;
  // What is longer than the diagonal never fits.
  longest_ = 0.5 * std::min(settings_.largest, math::hypot(area.width, area.depth));
  // Which share of the forms that keep no bounds fits: summed up over a grid, fine enough for a thousandth.
  constexpr int kAxes = 48;
  constexpr int kTurns = 32;
  const double shortest = 0.5 * settings_.smallest;
  range_ = math::log(longest_ / shortest);
  const auto half_axis = [&](int i) { return shortest * math::pow(longest_ / shortest, (i + 0.5) / kAxes); };
  std::array<double, kAxes> halves{};
  for (int i = 0; i < kAxes; ++i) halves[static_cast<std::size_t>(i)] = half_axis(i);
  // About round ones are hardly other from one to the next.
  constexpr int kApart = 3;
  std::array<Form, kAxes * kApart> rounds;
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    rounds[i].family = Form::Family::ellipse;
    Round(shortest, range_)
        .set(rounds[i], (static_cast<double>(i % kApart) + 0.5) / kApart,
             (static_cast<double>(i / kApart) + 0.5) / kAxes);
  }
  for (int turn = 0; turn < kTurns; ++turn) {
    Form form;
    form.turn(kPi * (turn + 0.5) / kTurns);
    for (const Form::Family family : {Form::Family::box, Form::Family::ellipse}) {
      form.family = family;
      const double share = this->family(form);
      const double of_round = family == Form::Family::ellipse ? settings_.round : 0.0;
      for (const double a : halves) {
        for (const double b : halves) {
          if (b > a) break;
          form.a = a;
          form.b = b;
          if (fits(form)) form_ += (b == a ? 1.0 : 2.0) * share * (1.0 - of_round);
        }
      }
      if (!(of_round > 0.0)) continue;
      for (Form& one : rounds) {
        one.cosine = form.cosine;
        one.sine = form.sine;
        if (fits(one)) form_ += kAxes * share * of_round / kApart;
      }
    }
  }
  form_ = longest_ > shortest ? form_ / (kAxes * kAxes * kTurns) : 0.0;
  if (!(form_ > 1e-5)) {
    throw Error("footprint", "hardly any outline of this prior fits into the area",
                "make smallest and largest smaller");
  }
  form_ = 1.0 / form_;
}

Form OutlinePrior::draw_form(double longest, Random& random) const {
  const double shortest = 0.5 * settings_.smallest;
  const auto half_axis = [&] { return shortest * math::pow(longest / shortest, random.uniform()); };
  Form out;
  out.family = random.uniform() < settings_.ellipses ? Form::Family::ellipse : Form::Family::box;
  if (out.family == Form::Family::ellipse && random.uniform() < settings_.round) {
    const double apart = random.uniform();
    Round(shortest, math::log(longest / shortest)).set(out, apart, random.uniform());
  } else {
    std::tie(out.b, out.a) = std::minmax({half_axis(), half_axis()});
  }
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

void OutlinePrior::draw_hole(Piece& piece, Random& random) const {
  const Form& form = piece.form;
  piece.hollow = true;
  if (random.uniform() < settings_.fitted) {
    const auto share = [&] { return kLeastShare + (kMostShare - kLeastShare) * random.uniform(); };
    const auto side = [&] { return random.uniform() < 0.5 ? 1 : -1; };
    const bool corner = form.family == Form::Family::box && random.uniform() < 0.5;
    piece.fit = corner ? Piece::Fit::corner : Piece::Fit::concentric;
    piece.along = share();
    piece.across = share();
    piece.side_a = side();
    piece.side_b = side();
    piece.fit_hole();
    return;
  }
  piece.fit = Piece::Fit::free;
  piece.hole = draw_form(form.a, random);
  double u, v;
  do {
    u = 2.0 * random.uniform() - 1.0;
    v = 2.0 * random.uniform() - 1.0;
  } while (form.family == Form::Family::ellipse && u * u + v * v > 1.0);
  piece.hole.x = form.x + form.cosine * u * form.a - form.sine * v * form.b;
  piece.hole.y = form.y + form.sine * u * form.a + form.cosine * v * form.b;
}

Piece OutlinePrior::draw_piece_or_hollow(Random& random) const {
  Piece out = draw_piece(random);
  if (random.uniform() >= whole(out.form)) {
    draw_hole(out, random);
    out.density = density(out);
  }
  return out;
}

Outline OutlinePrior::draw(Random& random) const {
  for (;;) {
    Outline out;
    double time = -math::log(1.0 - random.uniform());
    for (; time < settings_.expected && out.size() < settings_.most; time -= math::log(1.0 - random.uniform()))
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

double OutlinePrior::axes(const Form& form, double range) const {
  const double even = 2.0 / (range * range);
  if (form.family == Form::Family::box) return even / kPi;
  const double round = Round(0.5 * settings_.smallest, range).density(form);
  return ((1.0 - settings_.round) * even + settings_.round * round) / kPi;
}

double OutlinePrior::fitted_hole(const Piece& piece) const {
  constexpr double kEven = 1.0 / (kMostShare - kLeastShare);
  const auto possible = [](double share) { return share > kLeastShare && share < kMostShare; };
  const bool box = piece.form.family == Form::Family::box;
  if (!possible(piece.along)) return 0.0;
  if (piece.fit == Piece::Fit::concentric) return (box ? 0.5 : 1.0) * kEven;
  // One of four corners.
  return box && possible(piece.across) ? 0.5 * 0.25 * kEven * kEven : 0.0;
}

double OutlinePrior::density(const Piece& piece) const {
  const double centre = centre_density(piece.form);
  if (!(centre > 0.0)) return 0.0;
  const double of_form = centre * family(piece.form) * axes(piece.form, range_) * form_;
  // Nothing can be taken from a piece that is smaller.
  if (!piece.hollow) return of_form * whole(piece.form);
  const double of_hollow = of_form * (1.0 - whole(piece.form));
  if (!(of_hollow > 0.0)) return 0.0;
  if (piece.fitted()) return of_hollow * settings_.fitted * fitted_hole(piece);
  const double of_hole = hole_centre_density(piece.form, piece.hole);
  if (!(of_hole > 0.0)) return 0.0;
  return of_hollow * (1.0 - settings_.fitted) * of_hole * family(piece.hole) *
         axes(piece.hole, math::log(piece.form.a / (0.5 * settings_.smallest)));
}

}  // namespace palpate::footprints
