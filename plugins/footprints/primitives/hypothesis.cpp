// SPDX-License-Identifier: MIT
#include "hypothesis.hpp"

#include <palpate/error.hpp>

namespace palpate::footprints {
namespace {

// Range of Primitive::along and Primitive::across: the size of a concentric hole, or of the part of a hole at a corner
// that is inside the form, as fractions of the form's axes.
constexpr double kLeastShare = 0.1;
constexpr double kMostShare = 0.9;

/// Half axes of nearly round ellipses. The short half axis is at least `shortest`; `range` is the logarithm of the
/// longest half axis divided by `shortest`.
class NearlyRoundEllipses {
 public:
  NearlyRoundEllipses(double shortest, double range)
      : shortest_(shortest), range_(range), most_(std::min(kMostLog, 0.5 * range)) {}

  /// `apart` (for the ratio of the axes) and `size` (for the short axis) are in [0, 1]. If they are uniform, so are the
  /// logarithms of the ratio and of the short axis.
  void set(Form& form, double apart, double size) const {
    const double by = most_ * apart;
    form.b = shortest_ * math::exp((range_ - by) * size);
    form.a = form.b * math::exp(by);
  }
  double density(const Form& form) const {
    if (form.a > kMostRatio * form.b) return 0.0;
    const double by = math::log(form.a / form.b);
    return by < most_ ? 1.0 / (most_ * (range_ - by)) : 0.0;
  }

 private:
  static constexpr double kMostRatio = 1.06;
  static constexpr double kMostLog = 0.058268908123975775;  // ln 1.06
  double shortest_, range_, most_;
};

void carry(Form& form, const Target& to, double cosine, double sine) {
  form.x = to.x;
  form.y = to.y;
  form.turn_by(cosine, sine);
}

}  // namespace

Target random_position(const Form& form, Random& random) {
  double u, v;
  do {
    u = 2.0 * random.uniform() - 1.0;
    v = 2.0 * random.uniform() - 1.0;
  } while (form.family == Form::Family::ellipse && u * u + v * v > 1.0);
  return {form.x + form.cosine * u * form.a - form.sine * v * form.b,
          form.y + form.sine * u * form.a + form.cosine * v * form.b};
}

double Form::depth(double px, double py) const {
  const double u = cosine * (px - x) + sine * (py - y);
  const double v = cosine * (py - y) - sine * (px - x);
  if (family == Family::box) {
    const double along = a - std::abs(u);
    const double across = b - std::abs(v);
    return std::max(along, across) < 0.0 ? -std::sqrt(along * along + across * across) : std::min(along, across);
  }
  const double q = std::sqrt(u * u * (b * b) + v * v * (a * a)) / (a * b);
  const double slope = std::sqrt(u * u * (b * b * b * b) + v * v * (a * a * a * a)) / (a * a * b * b);
  return slope > 0.0 ? std::min(q * (1.0 - q) / slope, a - std::sqrt(u * u + v * v)) : b;
}

void Form::order_axes() {
  if (b <= a) return;
  std::swap(a, b);
  std::tie(cosine, sine) = std::pair(-sine, cosine);
}

bool overlap(const Form& one, const Form& other) {
  const double dx = other.x - one.x;
  const double dy = other.y - one.y;
  // Circumscribed and inscribed circles decide most cases.
  const double square = dx * dx + dy * dy;
  const double inner = one.b + other.b;
  if (square <= inner * inner) return true;
  const double outer = one.a + other.a;
  if (square > 2.0 * outer * outer) return false;
  // Separating axes: the line between the centres, and the axes of both forms.
  const double u = one.cosine * dx + one.sine * dy;
  const double v = one.cosine * dy - one.sine * dx;
  const double other_u = other.cosine * dx + other.sine * dy;
  const double other_v = other.cosine * dy - other.sine * dx;
  if (square > one.reach(one.a * u, one.b * v) + other.reach(other.a * other_u, other.b * other_v)) return false;
  const double c = one.cosine * other.cosine + one.sine * other.sine;
  const double s = one.cosine * other.sine - one.sine * other.cosine;
  return std::abs(u) <= one.a + other.reach(other.a * c, other.b * s) &&
         std::abs(v) <= one.b + other.reach(other.a * s, other.b * c) &&
         std::abs(other_u) <= other.a + one.reach(one.a * c, one.b * s) &&
         std::abs(other_v) <= other.b + one.reach(one.a * s, one.b * c);
}

void Primitive::fit_hole() {
  if (!fitted()) return;
  hole = form;
  if (fit == HolePlacement::concentric) {
    hole.a *= along;
    hole.b *= along;
    return;
  }
  // The hole is centred on the corner and extends beyond the form. If it ended at the form's sides, positions there
  // would count as near the primitive, and noise would make them ambiguous.
  const double u = side_a * form.a;
  const double v = side_b * form.b;
  hole.x += form.cosine * u - form.sine * v;
  hole.y += form.sine * u + form.cosine * v;
  hole.a *= 2.0 * along;
  hole.b *= 2.0 * across;
  hole.order_axes();
}

void Primitive::order_axes() {
  if (form.b <= form.a) return;
  form.order_axes();
  if (fit == HolePlacement::corner) std::swap(along, across);
  std::tie(side_a, side_b) = std::pair(side_b, -side_a);
}

Target Push::to_current(const Target& original) const {
  const double x = original.x - origin_x;
  const double y = original.y - origin_y;
  return {origin_x + cosine * x - sine * y + dx, origin_y + sine * x + cosine * y + dy};
}

Target Push::to_original(const Target& current) const {
  const double x = current.x - origin_x - dx;
  const double y = current.y - origin_y - dy;
  return {origin_x + cosine * x + sine * y, origin_y - sine * x + cosine * y};
}

Primitive Push::to_current(Primitive original) const {
  carry(original.form, to_current(Target{original.form.x, original.form.y}), cosine, sine);
  if (original.hollow) carry(original.hole, to_current(Target{original.hole.x, original.hole.y}), cosine, sine);
  return original;
}

Primitive Push::to_original(Primitive current) const {
  carry(current.form, to_original(Target{current.form.x, current.form.y}), cosine, -sine);
  if (current.hollow) carry(current.hole, to_original(Target{current.hole.x, current.hole.y}), cosine, -sine);
  return current;
}

Prior::Prior(const Settings& settings)
    : settings_(settings),
      // A form longer than the diagonal never fits.
      longest_(0.5 * std::min(settings.max_length, math::hypot(settings.area.width, settings.area.depth))),
      range_(math::log(longest_ / (0.5 * settings.min_width))) {
  constexpr double kRoom = 1.01;  // with a smaller ratio, almost no draw fits
  if (std::min(settings.area.width, settings.area.depth) < kRoom * settings.min_width)
    throw Error("footprint", "hardly any primitive of this prior fits into the area",
                "make min_width smaller or the area larger");
}

Form Prior::draw_form(double longest, Random& random) const {
  const double shortest = 0.5 * settings_.min_width;
  const double range = math::log(longest / shortest);
  const auto half_axis = [&] { return shortest * math::exp(range * random.uniform()); };
  Form out;
  out.family = random.uniform() < settings_.ellipses ? Form::Family::ellipse : Form::Family::box;
  if (out.family == Form::Family::ellipse && random.uniform() < settings_.round) {
    const double apart = random.uniform();
    NearlyRoundEllipses(shortest, range).set(out, apart, random.uniform());
  } else {
    std::tie(out.b, out.a) = std::minmax({half_axis(), half_axis()});
  }
  out.turn(kPi * random.uniform());
  return out;
}

bool Prior::in_bounds(const Form& form) const {
  return 2.0 * form.b >= settings_.min_width && form.a <= longest_ && form.a <= settings_.most_slender * form.b;
}

bool Prior::fits(const Form& form) const {
  return in_bounds(form) && 2.0 * form.reach_x() < settings_.area.width && 2.0 * form.reach_y() < settings_.area.depth;
}

Primitive Prior::draw_whole(Random& random) const {
  Primitive out;
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

void Prior::draw_hole(Primitive& primitive, Random& random) const {
  const Form& form = primitive.form;
  primitive.hollow = true;
  if (random.uniform() < settings_.fitted) {
    const auto share = [&] { return kLeastShare + (kMostShare - kLeastShare) * random.uniform(); };
    const auto side = [&] { return random.uniform() < 0.5 ? 1 : -1; };
    const bool corner = form.family == Form::Family::box && random.uniform() < 0.5;
    primitive.fit = corner ? Primitive::HolePlacement::corner : Primitive::HolePlacement::concentric;
    primitive.along = share();
    primitive.across = share();
    primitive.side_a = side();
    primitive.side_b = side();
    primitive.fit_hole();
    return;
  }
  primitive.fit = Primitive::HolePlacement::free;
  primitive.hole = draw_form(form.a, random);
  const Target centre = random_position(form, random);
  primitive.hole.x = centre.x;
  primitive.hole.y = centre.y;
}

Primitive Prior::draw_primitive(Random& random) const {
  Primitive out = draw_whole(random);
  if (random.uniform() >= whole_probability(out.form)) {
    draw_hole(out, random);
    out.density = density(out);
  }
  return out;
}

Hypothesis Prior::draw(Random& random) const {
  for (;;) {
    Hypothesis out;
    double time = -math::log(1.0 - random.uniform());
    for (; time < settings_.expected && out.primitives.size() < settings_.most;
         time -= math::log(1.0 - random.uniform()))
      out.primitives.add(draw_primitive(random));
    if (time >= settings_.expected) return out;
  }
}

double Prior::family(const Form& form) const {
  return form.family == Form::Family::ellipse ? settings_.ellipses : 1.0 - settings_.ellipses;
}

double Prior::centre_density(const Form& form) const {
  if (!in_bounds(form)) return 0.0;
  const double reach_x = form.reach_x();
  const double reach_y = form.reach_y();
  const double width = settings_.area.width;
  const double depth = settings_.area.depth;
  if (!(2.0 * reach_x < width && 2.0 * reach_y < depth)) return 0.0;
  if (form.x < reach_x || form.x + reach_x > width || form.y < reach_y || form.y + reach_y > depth) return 0.0;
  return 1.0 / ((width - 2.0 * reach_x) * (depth - 2.0 * reach_y));
}

double Prior::hole_centre_density(const Form& form, const Form& hole) const {
  if (2.0 * hole.b < settings_.min_width || hole.a > form.a) return 0.0;
  return form.contains(hole.x, hole.y) ? 1.0 / form.extent() : 0.0;
}

double Prior::axes(const Form& form, double range) const {
  const double uniform = 2.0 / (range * range);
  if (form.family == Form::Family::box) return uniform / kPi;
  const double round = NearlyRoundEllipses(0.5 * settings_.min_width, range).density(form);
  return ((1.0 - settings_.round) * uniform + settings_.round * round) / kPi;
}

double Prior::fitted_hole(const Primitive& primitive) const {
  constexpr double kUniform = 1.0 / (kMostShare - kLeastShare);
  const auto possible = [](double share) { return share > kLeastShare && share < kMostShare; };
  const bool box = primitive.form.family == Form::Family::box;
  if (!possible(primitive.along)) return 0.0;
  if (primitive.fit == Primitive::HolePlacement::concentric) return (box ? 0.5 : 1.0) * kUniform;
  // The factor 0.25 is the probability of one of four corners.
  return box && possible(primitive.across) ? 0.5 * 0.25 * kUniform * kUniform : 0.0;
}

double Prior::density(const Primitive& primitive) const {
  const double centre = centre_density(primitive.form);
  if (!(centre > 0.0)) return 0.0;
  const double of_form = centre * family(primitive.form) * axes(primitive.form, range_);
  if (!primitive.hollow) return of_form * whole_probability(primitive.form);
  const double of_hollow = of_form * (1.0 - whole_probability(primitive.form));
  if (!(of_hollow > 0.0)) return 0.0;
  if (primitive.fitted()) return of_hollow * settings_.fitted * fitted_hole(primitive);
  const double of_hole = hole_centre_density(primitive.form, primitive.hole);
  if (!(of_hole > 0.0)) return 0.0;
  return of_hollow * (1.0 - settings_.fitted) * of_hole * family(primitive.hole) *
         axes(primitive.hole, math::log(primitive.form.a / (0.5 * settings_.min_width)));
}

}  // namespace palpate::footprints
