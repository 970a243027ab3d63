// SPDX-License-Identifier: MIT
#include "proposals.hpp"

#include <palpate/math.hpp>

#include <cmath>
#include <cstdint>

namespace palpate::footprints {
namespace {

// Largest steps of the moves.
constexpr double kShift = 0.05;    // metres
constexpr double kTurn = 0.6;      // tangent of half of the angle
constexpr double kStretch = 0.3;   // see stretched()
constexpr double kHoleStep = 0.2;  // fraction of a form's axes, for a fitted hole

// Relative frequency of changes to a primitive near the latest tap, compared with other primitives.
constexpr double kNearWeight = 30.0;

// Standard deviations of a push along x and y, metres, and of its rotation, radians.
constexpr double kPushShift = 0.012;
constexpr double kPushTurn = 0.1;

/// Step sizes of one move, symmetric about 0, from one draw of 64 bits. Both have the same random scale, because
/// posteriors may be wide or narrow. The scale is between 1/20 and 1, with a uniform logarithm.
struct Steps {
  explicit Steps(Random& random) {
    constexpr int kScales = 16;
    static const std::array<double, kScales> scales = [] {
      std::array<double, kScales> out{};
      for (int i = 0; i < kScales; ++i)
        out[static_cast<std::size_t>(i)] = math::exp(math::log(1.0 / 20.0) * i / (kScales - 1.0));
      return out;
    }();
    const std::uint64_t bits = random.bits();
    const double scale = scales[bits % kScales];
    const auto uniform = [scale](std::uint64_t number) {
      return scale * (1.0 - 0x1.0p-27 * static_cast<double>(static_cast<std::int32_t>(number & 0xFFFFFFF)));
    };
    coin = (bits & 0x10) != 0;
    other_coin = (bits & 0x20) != 0;
    one = uniform(bits >> 8);
    other = uniform(bits >> 36);
  }

  double one, other;  ///< in [-1, 1]
  bool coin, other_coin;
};

/// Random choice of a primitive. Primitives near the latest tap have a larger probability.
class PrimitiveChoice {
 public:
  PrimitiveChoice(const ShortList<Primitive>& primitives, const Target& latest, Random& random) : latest_(latest) {
    if (primitives.size() == 1) return;
    std::array<double, ShortList<Primitive>::kMost> weights;
    for (int i = 0; i < primitives.size(); ++i) sum_ += weights[static_cast<std::size_t>(i)] = weight(primitives[i]);
    double left = random.uniform() * sum_;
    for (; index_ + 1 < primitives.size(); ++index_) {
      if ((left -= weights[static_cast<std::size_t>(index_)]) < 0.0) break;
    }
    weight_ = weights[static_cast<std::size_t>(index_)];
  }

  int index() const { return index_; }
  /// Returns p' / p: p is the present probability of choosing this primitive, and p' the probability of choosing it
  /// after `changed` has replaced it.
  double ratio(const Primitive& changed) const {
    if (!(sum_ > 0.0)) return 1.0;
    const double after = weight(changed);
    return (after / (sum_ - weight_ + after)) / (weight_ / sum_);
  }

 private:
  double weight(const Primitive& one) const { return one.near(latest_) ? kNearWeight : 1.0; }

  Target latest_;
  int index_ = 0;
  double sum_ = 0.0;  ///< sum of the weights, an integer
  double weight_ = 0.0;
};

int random_index(const ShortList<Primitive>& primitives, Random& random) {
  return static_cast<int>(random.index(static_cast<std::size_t>(primitives.size())));
}

/// Returns the density per square metre with which draw_about_taps() draws the centre of `form`. It places the form so
/// that a random object tap is at a uniform position in the form.
double density_about_taps(const Form& form, const Taps& taps) {
  int inside = 0;
  for (int i = 0; i < taps.size(); ++i) inside += taps.on(i) && form.contains(taps[i].x, taps[i].y) ? 1 : 0;
  return inside / (taps.objects() * form.extent());
}

/// Returns the prior density of a new primitive without a hole, divided by the density with which draw_about_taps()
/// draws it.
double ratio_about_taps(const Form& form, const Prior& prior, const Taps& taps) {
  const double drawn = density_about_taps(form, taps);
  return drawn > 0.0 ? prior.whole_probability(form) * prior.centre_density(form) / drawn : 0.0;
}

/// Draws a primitive without a hole around a random object tap. Returns false if there is no object tap, or if the
/// prior density is 0.
bool draw_about_taps(Primitive& out, const Prior& prior, const Taps& taps, Random& random) {
  if (taps.objects() == 0) return false;
  auto left = static_cast<int>(random.index(static_cast<std::size_t>(taps.objects())));
  int tap = 0;
  while (!taps.on(tap) || left-- > 0) ++tap;
  out = prior.draw_whole(random);
  out.form.x = taps[tap].x;
  out.form.y = taps[tap].y;
  const Target centre = random_position(out.form, random);
  out.form.x = centre.x;
  out.form.y = centre.y;
  out.density = prior.density(out);
  return out.density > 0.0;
}

void add(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, Random& random) {
  const int count = from.primitives.size();
  Primitive primitive;
  if (count >= prior.settings().most || !draw_about_taps(primitive, prior, taps, random)) return;
  // Primitives with holes result from two moves: a primitive without a hole, then its hole.
  out.ratio = prior.settings().expected / (count + 1) * ratio_about_taps(primitive.form, prior, taps);
  out.added.add(primitive);
}

void remove(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, Random& random) {
  const int count = from.primitives.size();
  if (count == 0) return;
  const int index = random_index(from.primitives, random);
  const Primitive& primitive = from.primitives[index];
  if (primitive.hollow) return;
  const double reverse = prior.settings().expected / count * ratio_about_taps(primitive.form, prior, taps);
  if (!(reverse > 0.0)) return;
  out.ratio = 1.0 / reverse;
  out.removed.add(index);
}

/// Replaces a random primitive by a new one.
void replace(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, Random& random) {
  if (from.primitives.size() == 0) return;
  const int index = random_index(from.primitives, random);
  Primitive& primitive = out.change(from, index);
  if (primitive.hollow) return;
  const double before = ratio_about_taps(primitive.form, prior, taps);
  if (!(before > 0.0) || !draw_about_taps(primitive, prior, taps, random)) return;
  out.ratio = ratio_about_taps(primitive.form, prior, taps) / before;
}

/// Draws a hole from the prior, or removes one. The densities of prior and proposal cancel.
void change_hole(Proposal& out, const Hypothesis& from, bool adds, const Prior& prior, Random& random) {
  if (from.primitives.size() == 0) return;
  const int index = random_index(from.primitives, random);
  if (from.primitives[index].hollow == adds || from.primitives[index].form.a < prior.settings().min_width) return;
  Primitive& primitive = out.change(from, index);
  if (adds) prior.draw_hole(primitive, random);
  primitive.hollow = adds;
  primitive.density = prior.density(primitive);
  if (!(primitive.density > 0.0)) return;
  const double odds = prior.settings().hole_probability / (1.0 - prior.settings().hole_probability);
  out.ratio = adds ? odds : 1.0 / odds;
}

// turn(): Rotates a form by 2 * atan(tangent). stretched(): Returns the factor of a stretch. The negative `tangent` or
// `step` is the reverse move, which has the same probability.
void turn(Form& form, double tangent) {
  const double square = tangent * tangent;
  form.turn_by((1.0 - square) / (1.0 + square), 2.0 * tangent / (1.0 + square));
}
double stretched(double step) { return (1.0 + step) / (1.0 - step); }

/// Stretches a form. With probability 1/2 an ellipse keeps its proportions, so that a round one stays round.
void stretch(Form& form, const Steps& steps) {
  const double one = stretched(kStretch * steps.one);
  form.a *= one;
  form.b *= form.family == Form::Family::ellipse && steps.coin ? one : stretched(kStretch * steps.other);
}

/// Moves one side; the opposite side stays. Returns the density of the reverse proposal divided by that of this
/// proposal. The ratio is not 1, because a symmetric step of a half axis is asymmetric in its logarithm.
double move_side(Form& form, const Steps& steps) {
  const bool along = steps.coin;
  double& half = along ? form.a : form.b;
  const double before = half;
  const double change = 0.5 * kShift * steps.one;
  half += change;
  if (half <= 0.0) return 0.0;
  const double side = steps.other_coin ? change : -change;
  form.x += side * (along ? form.cosine : -form.sine);
  form.y += side * (along ? form.sine : form.cosine);
  return before / half;
}

void change_family(Form& form) {
  constexpr double kSameExtent = 1.1283791670955126;  // sqrt(4 / pi): box and ellipse have equal areas
  const bool box = form.family == Form::Family::box;
  form.family = box ? Form::Family::ellipse : Form::Family::box;
  form.a *= box ? kSameExtent : 1.0 / kSameExtent;
  form.b *= box ? kSameExtent : 1.0 / kSameExtent;
}

/// Changes the size of a fitted hole. If the hole is at a corner of a box, sometimes changes the corner, too.
void change_fitted(Primitive& primitive, double which, const Steps& steps) {
  constexpr double kOtherCorner = 0.05;
  primitive.along += kHoleStep * steps.one;
  if (primitive.fit != Primitive::HolePlacement::corner) return;
  primitive.across += kHoleStep * steps.other;
  if (which < kOtherCorner) (steps.coin ? primitive.side_a : primitive.side_b) *= -1;
}

/// Changes the form of a primitive or of its hole. With `both`, a translation of the hole also translates the form.
/// `which`, uniform in [0, 1), selects the kind of change. Returns the density of the reverse proposal divided by that
/// of this proposal.
double change_part(Primitive& primitive, bool of_form, bool both, double which, const Steps& steps) {
  Form& form = of_form ? primitive.form : primitive.hole;
  double ratio = 1.0;
  if (which < 0.38) {
    const double dx = kShift * steps.one;
    const double dy = kShift * steps.other;
    form.x += dx;
    form.y += dy;
    if (both) {
      primitive.form.x += dx;
      primitive.form.y += dy;
    }
  } else if (which < 0.59) {
    turn(form, kTurn * steps.one);
  } else if (which < 0.78) {
    stretch(form, steps);
  } else if (which < 0.965) {
    ratio = move_side(form, steps);
  } else {
    change_family(form);
  }
  if (of_form) {
    primitive.order_axes();
  } else {
    form.order_axes();
  }
  return ratio;
}

void change_form(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, double which,
                 Random& random) {
  if (from.primitives.size() == 0) return;
  const PrimitiveChoice choice(from.primitives, taps.size() == 0 ? Target{} : taps[taps.size() - 1], random);
  Primitive& primitive = out.change(from, choice.index());
  const double before = primitive.density;
  const double part = primitive.hollow ? random.uniform() : 0.0;
  const Steps steps(random);
  double ratio = 1.0;
  if (primitive.fitted() && part > 0.6) {
    change_fitted(primitive, which, steps);
  } else {
    ratio = change_part(primitive, primitive.fitted() || part<0.5, part> 0.8, which, steps);
  }
  if (!(ratio > 0.0)) return;
  primitive.fit_hole();
  primitive.density = prior.density(primitive);
  if (!(primitive.density > 0.0)) return;
  out.ratio = ratio * primitive.density / before * choice.ratio(primitive);
}

// Fractions of the moves that do not change a form. A move and its reverse have equal fractions.
constexpr double kAddOrRemove = 0.03;  // each
constexpr double kMakeOrFillHole = 0.04;
constexpr double kReplace = 0.01;
constexpr double kNotOfForms = 2.0 * (kAddOrRemove + kMakeOrFillHole) + kReplace;

/// Draws a push from the prior. density() returns its density up to a constant factor.
Push draw_push(const Area& area, Random& random) {
  Push out;
  out.origin_x = 0.5 * area.width;
  out.origin_y = 0.5 * area.depth;
  out.dx = kPushShift * random.normal();
  out.dy = kPushShift * random.normal();
  const double angle = kPushTurn * random.normal();
  out.cosine = math::cos(angle);
  out.sine = math::sin(angle);
  return out;
}

double density(const Push& push) {
  const double angle = push.angle() / kPushTurn;
  return math::exp(-0.5 * ((push.dx * push.dx + push.dy * push.dy) / (kPushShift * kPushShift) + angle * angle));
}

/// Changes the time of a push (the number of taps before it), or its displacement. Returns false if the result is
/// impossible.
bool change_push(Push& push, int taps, Random& random) {
  if (random.uniform() < 0.25) {
    constexpr int kFarthest = 3;  // taps
    push.before += static_cast<int>(random.index(2 * kFarthest + 1)) - kFarthest;
    return push.before >= 1 && push.before < taps;
  }
  const Steps shift(random);
  push.dx += 2.0 * kPushShift * shift.one;
  push.dy += 2.0 * kPushShift * shift.other;
  const double angle = push.angle() + 2.0 * kPushTurn * Steps(random).one;
  push.cosine = math::cos(angle);
  push.sine = math::sin(angle);
  return true;
}

}  // namespace

void propose(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, double which,
             Random& random) {
  using Kind = Proposal::Kind;
  out.begin(from);
  out.kind = Kind::change_form;
  if (which >= kNotOfForms)
    return change_form(out, from, prior, taps, (which - kNotOfForms) / (1.0 - kNotOfForms), random);
  const auto is = [&](Kind kind, double share) {
    out.kind = kind;
    return (which -= share) < 0.0;
  };
  if (is(Kind::replace, kReplace)) return replace(out, from, prior, taps, random);
  if (is(Kind::add, kAddOrRemove)) return add(out, from, prior, taps, random);
  if (is(Kind::remove, kAddOrRemove)) return remove(out, from, prior, taps, random);
  if (is(Kind::make_hole, kMakeOrFillHole)) return change_hole(out, from, true, prior, random);
  out.kind = Kind::fill_hole;
  change_hole(out, from, false, prior, random);
}

void propose_noise(Proposal& out, const Hypothesis& from) {
  out.begin(from);
  out.kind = Proposal::Kind::flip_noise;
  out.ratio = 1.0;
  out.noisy = !from.noisy;
  for (int i = 0; i < from.primitives.size(); ++i) out.change(from, i);
}

void propose_push(Proposal& out, const Hypothesis& from, const Prior& prior, int taps, double rate, Random& random) {
  out.begin(from);
  out.kind = Proposal::Kind::push;
  const bool moves_along = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    // The effect of a push often appears some taps later. With probability 1/2, the push is therefore proposed among
    // the latest taps.
    constexpr int kLatest = 6;
    const int latest = std::min(kLatest, taps - 1);
    const auto ratio = [&](int before) {
      return rate / (0.5 / (taps - 1) + (before >= taps - latest ? 0.5 / latest : 0.0));
    };
    if (from.push) {
      out.push = Push();
      out.ratio = 1.0 / ratio(from.push.before);
    } else {
      out.push = draw_push(prior.settings().area, random);
      const int among = random.uniform() < 0.5 ? latest : taps - 1;
      out.push.before = taps - 1 - static_cast<int>(random.index(static_cast<std::size_t>(among)));
      out.ratio = ratio(out.push.before);
    }
  } else {
    if (!from.push || !change_push(out.push, taps, random)) return;
    out.ratio = density(out.push) / density(from.push);
  }
  for (int i = 0; i < from.primitives.size(); ++i) {
    Primitive& primitive = out.change(from, i);
    if (!moves_along) continue;
    if (from.push) primitive = from.push.to_original(primitive);
    if (out.push) primitive = out.push.to_current(primitive);
    primitive.density = prior.density(primitive);
    out.ratio *= primitive.density / from.primitives[i].density;
  }
}

}  // namespace palpate::footprints
