// SPDX-License-Identifier: MIT
// Splitting a primitive and merging two (Richardson and Green 1997). The parts are drawn about those of a cut, the
// whole about the form with the moments of both.
#include "proposals.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::footprints {
namespace {

/// A form drawn about another, family by the prior.
class About {
 public:
  explicit About(const Form& fit) : fit_(fit), shift_(kShift * std::sqrt(fit.a * fit.b)) {}

  Form draw(const Prior& prior, Random& random) const {
    Form out = fit_;
    out.family = random.uniform() < prior.settings().ellipses ? Form::Family::ellipse : Form::Family::box;
    out.x += shift_ * normal(random);
    out.y += shift_ * normal(random);
    out.a *= math::exp(kSize * normal(random));
    out.b *= math::exp(kSize * normal(random));
    out.turn(kAngle * normal(random));
    return out;
  }

  /// In centre, angle and logarithms of the half axes. Those whose half axes are not in order are never taken.
  double density(const Prior& prior, const Form& form) const {
    const auto square = [](double x) { return x * x; };
    const double apart = square((form.x - fit_.x) / shift_) + square((form.y - fit_.y) / shift_) +
                         square(math::log(form.a / fit_.a) / kSize) + square(math::log(form.b / fit_.b) / kSize);
    return factor(prior, form) / (fit_.a * fit_.b) *
           turned(fit_.cosine * form.sine - fit_.sine * form.cosine,
                  fit_.cosine * form.cosine + fit_.sine * form.sine) *
           math::exp(-0.5 * apart);
  }

  // The parts of this density, for one about many forms. How much of it the family has, times a density's factor but
  // for the product of the half axes.
  static double factor(const Prior& prior, const Form& form) {
    constexpr double kNormals = 0.010105326013811644;  // (2 pi)^-5/2
    const double ellipses = prior.settings().ellipses;
    const double family = form.family == Form::Family::ellipse ? ellipses : 1.0 - ellipses;
    return family * kNormals / (kShift * kShift * kSize * kSize * kAngle);
  }
  /// Of an angle that has such a sine and cosine: directions have no sign.
  static double turned(double sine, double cosine) {
    const double angle = math::atan2(sine / cosine, 1.0);
    const double there = angle / kAngle;
    const double other_way = (std::abs(angle) - kPi) / kAngle;
    return math::exp(-0.5 * there * there) + math::exp(-0.5 * other_way * other_way);
  }

  static constexpr double kShift = 0.25;  // of the mean half axis
  static constexpr double kSize = 0.3;    // of a logarithm
  static constexpr double kAngle = 0.3;   // radians

 private:
  Form fit_;
  double shift_;
};

/// The halves, or unequal parts, of a form that is cut across one of its axes; the ways to do so are equally probable.
constexpr int kCuts = 12;
constexpr std::array<double, 3> kShares{0.3, 0.5, 0.7};
double share_of(int way) { return kShares[static_cast<std::size_t>(way % 3)]; }
bool is_along(int way) { return (way / 3) % 2 == 0; }

std::pair<Form, Form> cut(const Form& form, int way) {
  const double share = share_of(way);
  const bool along = is_along(way);
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
  const double spread = math::hypot(0.5 * (xx - yy), xy);
  out.a = std::sqrt(3.0 * (middle + spread));
  out.b = std::sqrt(3.0 * std::max(middle - spread, 0.0));
  out.turn(0.5 * math::atan2(2.0 * xy, xx - yy));
  return out;
}

/// How probable it is that two of the primitives are those that are merged: one of them is any, the other near it.
class Pairs {
 public:
  explicit Pairs(const ShortList<Primitive>& primitives) : size_(primitives.size()) {
    constexpr double kClose = 0.05;  // metres
    for (int a = 0; a < size_; ++a) {
      for (int b = 0; b < a; ++b) {
        const Form& one = primitives[a].form;
        const Form& other = primitives[b].form;
        wish(a, b) = wish(b, a) = math::exp(-math::hypot(one.x - other.x, one.y - other.y) / kClose);
      }
      wish(a, a) = 0.0;
    }
    for (int a = 0; a < size_; ++a) {
      for (int b = 0; b < size_; ++b) sums_[static_cast<std::size_t>(a)] += wish(a, b);
    }
  }

  double probability(int a, int b) {
    return (wish(a, b) / sums_[static_cast<std::size_t>(a)] + wish(b, a) / sums_[static_cast<std::size_t>(b)]) / size_;
  }

  std::pair<int, int> choose(Random& random) {
    double left = random.uniform();
    std::pair<int, int> out;
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k < i; ++k) {
        out = {k, i};
        if ((left -= probability(k, i)) < 0.0) return out;
      }
    }
    return out;
  }

 private:
  double& wish(int a, int b) { return wishes_[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)]; }

  int size_;
  std::array<std::array<double, ShortList<Primitive>::kMost>, ShortList<Primitive>::kMost> wishes_;
  std::array<double, ShortList<Primitive>::kMost> sums_{};
};

/// A part as About has it for all cuts of a whole, so that logarithms and angles are asked for once.
class Part {
 public:
  Part(const Prior& prior, const Form& whole, const Form& part)
      : whole_(whole),
        part_(part),
        along_(math::log(part.a / whole.a)),
        across_(math::log(part.b / whole.b)),
        slender_(math::log(whole.a / whole.b)),
        factor_(About::factor(prior, part) / (whole.a * whole.b)) {
    const double sine = whole.cosine * part.sine - whole.sine * part.cosine;
    const double cosine = whole.cosine * part.cosine + whole.sine * part.sine;
    turned_[0] = About::turned(sine, cosine);
    turned_[1] = About::turned(-cosine, sine);
  }

  /// Its density is a factor times e to minus half of something.
  struct Density {
    double factor, exponent;
  };
  /// About a form that has such a share of the whole, of whose axes the long or the short one is cut.
  Density about(const Form& fit, double share, double log_share, bool along) const {
    // Axes are named anew where the long one has become the shorter.
    const bool swapped = along && whole_.a * share < whole_.b;
    const double a = (swapped ? along_ + slender_ : along_ - (along ? log_share : 0.0)) / About::kSize;
    const double b = (swapped ? across_ - slender_ - log_share : across_ - (along ? 0.0 : log_share)) / About::kSize;
    const double dx = part_.x - fit.x;
    const double dy = part_.y - fit.y;
    const double square = About::kShift * About::kShift * share * whole_.a * whole_.b;
    return {factor_ / share * turned_[swapped ? 1 : 0], (dx * dx + dy * dy) / square + a * a + b * b};
  }

 private:
  Form whole_;
  Form part_;
  double along_, across_;  ///< logarithms of its half axes over those of the whole
  double slender_;         ///< of the whole
  double factor_;
  double turned_[2];
};

/// The density of two parts, whichever comes first, as split() draws them.
double density_of_split(const Prior& prior, const Form& whole, const Form& first, const Form& second) {
  const Part one(prior, whole, first);
  const Part other(prior, whole, second);
  static const std::array<double, 3> logs{math::log(kShares[0]), math::log(kShares[1]), math::log(kShares[2])};
  const auto log_of = [](int share) { return logs[static_cast<std::size_t>(share)]; };
  double out = 0.0;
  for (int way = 0; way < kCuts; ++way) {
    const auto [a, b] = cut(whole, way);
    // What one part leaves to the other is a share, too.
    const Part::Density of_one = one.about(a, share_of(way), log_of(way % 3), is_along(way));
    const Part::Density of_other = other.about(b, 1.0 - share_of(way), log_of(2 - way % 3), is_along(way));
    out += of_one.factor * of_other.factor * math::exp(-0.5 * (of_one.exponent + of_other.exponent));
  }
  return 2.0 * out / kCuts;
}

/// The ratio of splitting `whole`, one of `count` primitives; `split`: the primitives afterwards.
double ratio_of_split(const Prior& prior, const ShortList<Primitive>& split, std::pair<int, int> parts,
                      const Primitive& whole, int count) {
  const Primitive& first = split[parts.first];
  const Primitive& second = split[parts.second];
  const double there = density_of_split(prior, whole.form, first.form, second.form) / count;
  const double back = Pairs(split).probability(parts.first, parts.second) *
                      About(joined(first.form, second.form)).density(prior, whole.form);
  return prior.settings().expected * first.density * second.density / whole.density * back / there;
}

/// Gives a form its density; false if the prior does not allow it.
bool complete(Primitive& primitive, const Prior& prior) {
  if (primitive.form.b > primitive.form.a) return false;
  primitive.density = prior.density(primitive);
  return primitive.density > 0.0;
}

}  // namespace

void propose_split(Proposal& out, const Hypothesis& from, const Prior& prior, Random& random) {
  out.begin(from);
  out.kind = Proposal::Kind::split;
  const int count = from.primitives.size();
  if (count == 0 || count >= prior.settings().most) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(count)));
  const Primitive& whole = from.primitives[one];
  if (whole.hollow) return;
  const auto [a, b] = cut(whole.form, static_cast<int>(random.index(kCuts)));
  Primitive first, second;
  first.form = About(a).draw(prior, random);
  second.form = About(b).draw(prior, random);
  if (!complete(first, prior) || !complete(second, prior)) return;
  ShortList<Primitive> split = from.primitives;
  split[one] = first;
  split.add(second);
  out.removed.add(one);
  out.added.add(first);
  out.added.add(second);
  out.ratio = ratio_of_split(prior, split, {one, count}, whole, count);
}

void propose_merge(Proposal& out, const Hypothesis& from, const Prior& prior, Random& random) {
  out.begin(from);
  out.kind = Proposal::Kind::merge;
  const int count = from.primitives.size();
  if (count < 2) return;
  const std::pair<int, int> parts = Pairs(from.primitives).choose(random);
  const Primitive& first = from.primitives[parts.first];
  const Primitive& second = from.primitives[parts.second];
  if (first.hollow || second.hollow) return;
  Primitive whole;
  whole.form = About(joined(first.form, second.form)).draw(prior, random);
  if (!complete(whole, prior)) return;
  out.removed.add(parts.first);
  out.removed.add(parts.second);
  out.added.add(whole);
  out.ratio = 1.0 / ratio_of_split(prior, from.primitives, parts, whole, count - 1);
}

}  // namespace palpate::footprints
