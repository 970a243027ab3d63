// SPDX-License-Identifier: MIT
// Splits a piece and merges two (Richardson and Green 1997): the parts are drawn about those of a cut, the whole about
// the form that two have together.
#include "proposals.hpp"
#include "steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::footprints {
namespace {

/// A form drawn about another, family by the prior.
class About {
 public:
  explicit About(const Form& fit) : fit_(fit), shift_(0.25 * std::sqrt(fit.a * fit.b)) {}

  Form draw(const OutlinePrior& prior, Random& random) const {
    Form out = fit_;
    out.family = random.uniform() < prior.settings().ellipses ? Form::Family::ellipse : Form::Family::box;
    out.x += shift_ * normal(random);
    out.y += shift_ * normal(random);
    out.a *= std::exp(kSize * normal(random));
    out.b *= std::exp(kSize * normal(random));
    out.turn(kAngle * normal(random));
    return out;
  }

  /// In centre, angle and logarithms of the half axes. Those whose half axes are not in order are never taken.
  double density(const OutlinePrior& prior, const Form& form) const {
    const double sine = fit_.cosine * form.sine - fit_.sine * form.cosine;
    const double cosine = fit_.cosine * form.cosine + fit_.sine * form.sine;
    const double angle = std::atan(sine / cosine);  // directions have no sign
    const double family =
        form.family == Form::Family::ellipse ? prior.settings().ellipses : 1.0 - prior.settings().ellipses;
    const auto square = [](double x) { return x * x; };
    const double apart = square((form.x - fit_.x) / shift_) + square((form.y - fit_.y) / shift_) +
                         square(std::log(form.a / fit_.a) / kSize) + square(std::log(form.b / fit_.b) / kSize);
    const double turned = square(angle / kAngle);
    const double other_way = square((std::abs(angle) - kPi) / kAngle);
    constexpr double kNormals = 0.010105326013811644;  // (2 pi)^-5/2
    return family * kNormals / (shift_ * shift_ * kSize * kSize * kAngle) *
           (std::exp(-0.5 * (apart + turned)) + std::exp(-0.5 * (apart + other_way)));
  }

 private:
  static constexpr double kSize = 0.3;
  static constexpr double kAngle = 0.3;  // radians
  Form fit_;
  double shift_;
};

/// The halves, or unequal parts, of a form that is cut across one of its axes; the ways to do so are equally probable.
constexpr int kCuts = 12;
std::pair<Form, Form> cut(const Form& form, int way) {
  constexpr std::array<double, 3> kShares{0.3, 0.5, 0.7};
  const double share = kShares[static_cast<std::size_t>(way % 3)];
  const bool along = (way / 3) % 2 == 0;
  const double sign = way / 6 == 0 ? 1.0 : -1.0;  // so that the two may be named either way round
  std::pair<Form, Form> out(form, form);
  const double half = along ? form.a : form.b;
  const double dx = sign * (along ? form.cosine : -form.sine);
  const double dy = sign * (along ? form.sine : form.cosine);
  const auto part = [&](Form& one, double size, double at) {
    (along ? one.a : one.b) = half * size;
    one.x += dx * half * at;
    one.y += dy * half * at;
    one.order_axes();
  };
  part(out.first, share, -(1.0 - share));
  part(out.second, 1.0 - share, share);
  return out;
}

/// A form with the extent and the moments of two: of two halves the whole.
Form joined(const Form& first, const Form& second) {
  const double of_first = first.extent();
  const double of_second = second.extent();
  const double share = of_first / (of_first + of_second);
  Form out;
  out.x = share * first.x + (1.0 - share) * second.x;
  out.y = share * first.y + (1.0 - share) * second.y;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  const auto add = [&](const Form& form, double weight) {
    const double of = form.family == Form::Family::box ? 1.0 / 3.0 : 0.25;
    const double aa = of * form.a * form.a;
    const double bb = of * form.b * form.b;
    const double dx = form.x - out.x;
    const double dy = form.y - out.y;
    xx += weight * (aa * form.cosine * form.cosine + bb * form.sine * form.sine + dx * dx);
    yy += weight * (aa * form.sine * form.sine + bb * form.cosine * form.cosine + dy * dy);
    xy += weight * ((aa - bb) * form.sine * form.cosine + dx * dy);
  };
  add(first, share);
  add(second, 1.0 - share);
  const double middle = 0.5 * (xx + yy);
  const double spread = std::hypot(0.5 * (xx - yy), xy);
  out.a = std::sqrt(3.0 * (middle + spread));
  out.b = std::sqrt(3.0 * std::max(middle - spread, 0.0));
  out.turn(0.5 * std::atan2(2.0 * xy, xx - yy));
  return out;
}

/// How probable it is that two of the pieces are those that are merged: one of them is any, the other near it.
double choice_of_pair(const Outline& outline, int first, int second) {
  constexpr double kClose = 0.05;  // metres
  const auto wish = [&](int a, int b) {
    return std::exp(-std::hypot(outline[a].form.x - outline[b].form.x, outline[a].form.y - outline[b].form.y) / kClose);
  };
  const auto given = [&](int a, int b) {
    double sum = 0.0;
    for (int i = 0; i < outline.size(); ++i) sum += i == a ? 0.0 : wish(a, i);
    return wish(a, b) / sum;
  };
  return (given(first, second) + given(second, first)) / outline.size();
}

std::pair<int, int> choose_pair(const Outline& outline, Random& random) {
  double left = random.uniform();
  std::pair<int, int> out;
  for (int i = 0; i < outline.size(); ++i) {
    for (int k = 0; k < i; ++k) {
      out = {k, i};
      if ((left -= choice_of_pair(outline, k, i)) < 0.0) return out;
    }
  }
  return out;
}

/// The density of two parts, whichever comes first, as split() draws them.
double density_of_split(const OutlinePrior& prior, const Form& whole, const Form& first, const Form& second) {
  double out = 0.0;
  for (int way = 0; way < kCuts; ++way) {
    const auto [a, b] = cut(whole, way);
    out += About(a).density(prior, first) * About(b).density(prior, second);
  }
  return 2.0 * out / kCuts;
}

/// Of `pieces` forms one more.
double correction_of_split(const OutlinePrior& prior, const Outline& split, std::pair<int, int> parts,
                           const Piece& whole, int pieces) {
  const Piece& first = split[parts.first];
  const Piece& second = split[parts.second];
  const double way_there = density_of_split(prior, whole.form, first.form, second.form) / pieces;
  const double way_back = choice_of_pair(split, parts.first, parts.second) *
                          About(joined(first.form, second.form)).density(prior, whole.form);
  return prior.settings().expected * first.density * second.density / whole.density * way_back / way_there;
}

bool in_order(const Form& form) { return form.b <= form.a; }

}  // namespace

void propose_split(Proposal& out, const OutlinePrior& prior, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0 || pieces >= prior.settings().most) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  const Piece whole = out.outline[one];
  if (whole.hollow) return;
  const auto [a, b] = cut(whole.form, static_cast<int>(random.index(kCuts)));
  Piece first, second;
  first.form = About(a).draw(prior, random);
  second.form = About(b).draw(prior, random);
  if (!in_order(first.form) || !in_order(second.form)) return;
  first.density = prior.density(first);
  second.density = prior.density(second);
  if (first.density <= 0.0 || second.density <= 0.0) return;
  out.outline[one] = first;
  out.changes(one);
  out.add(second);
  out.correction = correction_of_split(prior, out.outline, {one, pieces}, whole, pieces);
}

void propose_merge(Proposal& out, const OutlinePrior& prior, Random& random) {
  const int pieces = out.outline.size();
  if (pieces < 2) return;
  const Outline before = out.outline;
  const std::pair<int, int> parts = choose_pair(before, random);
  const Form& first = before[parts.first].form;
  const Form& second = before[parts.second].form;
  if (before[parts.first].hollow || before[parts.second].hollow) return;
  Piece whole;
  whole.form = About(joined(first, second)).draw(prior, random);
  if (!in_order(whole.form)) return;
  whole.density = prior.density(whole);
  if (whole.density <= 0.0) return;
  out.outline[parts.first] = whole;
  out.changes(parts.first);
  out.remove(parts.second);
  out.correction = 1.0 / correction_of_split(prior, before, parts, whole, pieces - 1);
}

}  // namespace palpate::footprints
