// SPDX-License-Identifier: MIT
// Hypotheses by the simplest definitions: positions inside, by corners and foci; primitives with an object tap;
// positions after a push; probabilities of labels and heights. And numbers by which distributions of hypotheses are
// compared.
#pragma once

#include "primitives/sampler.hpp"

#include <palpate/footprint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace palpate::footprints {

using Point = std::array<double, 2>;

/// The prior of the default config.
inline Prior::Settings default_prior(double expected = 2.0) {
  Prior::Settings out;
  out.area = {0.23, 0.23};
  out.expected = expected;
  return out;
}

/// A sampler with this prior, `moves` after each tap, and one probability of errors of both labels.
inline Sampler sampler_of(int particles, double moves, double error, std::uint64_t seed, double noise = 0.0) {
  SamplerSettings how;
  how.particles = particles;
  how.moves = how.moves_apart = moves;
  how.label_error = how.false_contact = error;
  how.position_noise = noise;
  return {Prior(default_prior()), how, Random(seed, "particles test")};
}

/// Draws a standard normal number (Box and Muller 1958).
inline double standard_normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

/// Returns the taps at their positions after a push.
inline std::vector<Touch> touches_after(const Push& push, std::vector<Touch> touches) {
  using Complex = std::complex<double>;
  const Complex origin(push.origin_x, push.origin_y);
  for (std::size_t i = 0; i < static_cast<std::size_t>(push.before); ++i) {
    const Complex from(touches[i].place.x, touches[i].place.y);
    const Complex to = origin + Complex(push.dx, push.dy) + Complex(push.cosine, push.sine) * (from - origin);
    touches[i].place = {to.real(), to.imag()};
  }
  return touches;
}

/// The probability that a tap with noise of this standard deviation is made at a depth of 0 or more, metres.
inline double probability_inside(double depth, double noise) {
  return noise > 0.0 ? 0.5 * std::erfc(-depth / noise / std::sqrt(2.0)) : (depth >= 0.0 ? 1.0 : 0.0);
}

/// `along` and `across` from the centre, in the form's own frame.
inline Point placed(const Form& o, double along, double across) {
  return {o.x + o.cosine * along - o.sine * across, o.y + o.sine * along + o.cosine * across};
}

/// How far inside of a form a point is, roughly in metres; negative outside. A box lies on one side of each of its
/// edges, an ellipse where the distances from its foci come to less than its length.
inline double inside_of(const Form& o, const Point& p) {
  if (o.family == Form::Family::ellipse) {
    const double focus = std::sqrt(o.a * o.a - o.b * o.b);
    const Point one = placed(o, focus, 0.0);
    const Point other = placed(o, -focus, 0.0);
    return 2.0 * o.a - std::hypot(p[0] - one[0], p[1] - one[1]) - std::hypot(p[0] - other[0], p[1] - other[1]);
  }
  const std::array<Point, 4> corners{placed(o, o.a, o.b), placed(o, -o.a, o.b), placed(o, -o.a, -o.b),
                                     placed(o, o.a, -o.b)};
  double out = 1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& from = corners[i];
    const Point& to = corners[(i + 1) % 4];
    const double edge = std::hypot(to[0] - from[0], to[1] - from[1]);
    out = std::min(out, ((to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])) / edge);
  }
  return out;
}

/// No point of a form is farther from its centre.
inline double radius_of(const Form& form) { return std::hypot(form.a, form.b); }

/// Nearer to a rim, both definitions may differ by rounding, metres.
constexpr double kOnTheRim = 1e-12;

/// Whether a primitive contains a tap that has the label of an object.
inline bool has_object_tap(const Primitive& primitive, const std::vector<Touch>& touches) {
  return std::any_of(touches.begin(), touches.end(),
                     [&](const Touch& one) { return one.on && primitive.contains(one.place.x, one.place.y); });
}

/// The density of a height given another one, relative to any height, on a top that is level up to `slope`.
inline double height_gain(const Touch& one, const Touch& other, double slope) {
  const double scale = std::hypot(0.004, slope * std::hypot(one.place.x - other.place.x, one.place.y - other.place.y));
  const double deviation = (one.height - other.height) / scale;
  return 0.15 * 0.98 * std::exp(-0.5 * deviation * deviation) / (scale * std::sqrt(2.0 * kPi)) + 0.02;
}

/// The density of the heights relative to any heights, by the definition of TapHeightModel: primitive by primitive.
/// Distances are those of the taps as made; primitives contain taps as `seen` after a push.
inline double height_evidence(const Hypothesis& hypothesis, const std::vector<Touch>& touches,
                              const std::vector<Touch>& seen) {
  const auto holds = [&](const Primitive& primitive, std::size_t tap) {
    return primitive.contains(seen[tap].place.x, seen[tap].place.y);
  };
  const auto nearest_before = [&](std::size_t i, const auto& counts) {
    const Touch* out = nullptr;
    double nearest = 1e9;
    for (std::size_t k = 0; k < i; ++k) {
      const double distance =
          std::hypot(touches[i].place.x - touches[k].place.x, touches[i].place.y - touches[k].place.y);
      if (!touches[k].on || distance >= nearest || !counts(k)) continue;
      nearest = distance;
      out = &touches[k];
    }
    return out;
  };
  double out = 1.0;
  for (const Primitive& primitive : hypothesis.primitives) {
    double level = 1.0;
    double slope = 1.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      if (!touches[i].on || !holds(primitive, i)) continue;
      const auto holders = std::count_if(hypothesis.primitives.begin(), hypothesis.primitives.end(),
                                         [&](const Primitive& other) { return holds(other, i); });
      const double part = 1.0 / static_cast<double>(holders);
      if (const Touch* in_it = nearest_before(i, [&](std::size_t tap) { return holds(primitive, tap); })) {
        level *= std::pow(height_gain(touches[i], *in_it, 0.05), part);
        slope *= std::pow(height_gain(touches[i], *in_it, 0.5), part);
      } else if (const Touch* beside = nearest_before(i, [](std::size_t) { return true; })) {
        out *= std::pow(0.7 + 0.3 * height_gain(touches[i], *beside, 0.05), part);
      }
    }
    out *= 0.5 * level + 0.3 * slope + 0.2;
  }
  return out;
}

/// The primitives with an object tap and those without; both together fit into one hypothesis.
struct Parts {
  Hypothesis seen, undiscovered;
};
inline Parts parts_of(const Hypothesis& hypothesis, const std::vector<Touch>& touches) {
  Parts out;
  for (const Primitive& primitive : hypothesis.primitives)
    (has_object_tap(primitive, touches) ? out.seen : out.undiscovered).primitives.add(primitive);
  return out;
}

/// Whether a primitive at least this long, metres, has no object tap and overlaps none that has one.
inline bool has_undiscovered(const Hypothesis& hypothesis, const std::vector<Touch>& touches, double length) {
  const Parts parts = parts_of(hypothesis, touches);
  const auto apart = [&](const Primitive& one) {
    return std::none_of(parts.seen.primitives.begin(), parts.seen.primitives.end(),
                        [&](const Primitive& known) { return overlap(known.form, one.form); });
  };
  return std::any_of(parts.undiscovered.primitives.begin(), parts.undiscovered.primitives.end(),
                     [&](const Primitive& one) { return 2.0 * one.form.a >= length && apart(one); });
}

/// Draws the primitives of the prior with an object tap, up to its `most`. Their number without this limit is
/// Poisson's.
inline Hypothesis drawn_known(const Prior& prior, const std::vector<Touch>& touches, Random& random) {
  const Prior::Settings& settings = prior.settings();
  for (;;) {
    Hypothesis out;
    bool too_many = false;
    double time = -std::log(1.0 - random.uniform());
    for (; time < settings.expected && !too_many; time -= std::log(1.0 - random.uniform())) {
      const Primitive primitive = prior.draw_primitive(random);
      if (!has_object_tap(primitive, touches)) continue;
      too_many = out.primitives.size() == settings.most;
      if (!too_many) out.primitives.add(primitive);
    }
    if (!too_many) return out;
  }
}

/// Returns the probabilities of 0 to `most` of a Poisson distribution that is cut off above.
inline std::vector<double> poisson(double mean, int most) {
  std::vector<double> out{1.0};
  double sum = 1.0;
  for (int i = 1; i <= most; ++i) {
    out.push_back(out.back() * mean / i);
    sum += out.back();
  }
  for (double& one : out) one /= sum;
  return out;
}

/// Returns the standard normal deviation that is as improbable as this sum of squares of `freedom` standard normal
/// deviations (Wilson and Hilferty 1931).
inline double deviation_of_chi_square(double sum, double freedom) {
  const double spread = 2.0 / (9.0 * freedom);
  return (std::cbrt(sum / freedom) - (1.0 - spread)) / std::sqrt(spread);
}

/// Returns the same for counts whose expectations are known. Neighbours are merged until each expectation is at least
/// 20; a smaller rest at the end belongs to the last of them.
inline double deviation_from(const std::vector<double>& expected, const std::vector<long>& counts) {
  struct Cell {
    double expected = 0.0, count = 0.0;
  };
  std::vector<Cell> cells(1);
  double rest = std::accumulate(expected.begin(), expected.end(), 0.0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (cells.back().expected >= 20.0 && rest >= 20.0) cells.emplace_back();
    cells.back().expected += expected[i];
    cells.back().count += static_cast<double>(counts[i]);
    rest -= expected[i];
  }
  double sum = 0.0;
  for (const Cell& one : cells) sum += (one.count - one.expected) * (one.count - one.expected) / one.expected;
  return deviation_of_chi_square(sum, static_cast<double>(cells.size()) - 1.0);
}

/// A number by which two distributions may differ, in [0, 1]; negative if it is undefined, as for a missing hole.
struct Number {
  const char* name;
  double value;
};

inline double direction_of(const Form& form) {
  const double turns = std::atan2(form.sine, form.cosine) / kPi;
  return turns - std::floor(turns);
}

/// The numbers of a primitive: its kind, position and size.
inline constexpr std::size_t kNumbers = 18;
inline std::array<Number, kNumbers> numbers_of(const Primitive& primitive, const Prior::Settings& prior) {
  const Form& form = primitive.form;
  const Form& hole = primitive.hole;
  const double sizes = std::log(prior.max_length / prior.min_width);
  const auto size = [&](double half) { return std::log(2.0 * half / prior.min_width) / sizes; };
  const auto of_hole = [&](double value) { return primitive.hollow && !primitive.fitted() ? value : -1.0; };
  const bool corner = primitive.fitted() && primitive.fit == Primitive::HolePlacement::corner;
  // Half a turn changes nothing in a form, and the corner of its hole becomes the opposite one.
  const int about = form.sine < 0.0 || (form.sine == 0.0 && form.cosine < 0.0) ? -1 : 1;
  const double dx = hole.x - form.x;
  const double dy = hole.y - form.y;
  return {{{"x", form.x / prior.area.width},
           {"y", form.y / prior.area.depth},
           {"direction", direction_of(form)},
           {"log a", size(form.a)},
           {"log b", size(form.b)},
           {"slenderness", std::log(form.a / form.b) / std::log(prior.most_slender)},
           {"an ellipse", form.family == Form::Family::ellipse ? 0.99 : 0.01},
           {"size of ellipses", form.family == Form::Family::ellipse ? size(form.a) : -1.0},
           {"edge", std::min(form.x - form.reach_x(), form.y - form.reach_y()) / prior.area.width},
           {"a hole", primitive.hollow ? 0.99 : 0.01},
           {"log a of hole", of_hole(std::log(2.0 * hole.a / prior.min_width + 1e-9) / sizes)},
           {"slenderness of hole", of_hole(std::log(hole.a / hole.b) / sizes)},
           {"direction of hole", of_hole(direction_of(hole))},
           {"place of hole", of_hole(0.5 + 0.5 * (form.cosine * dx + form.sine * dy) / form.a)},
           {"a hole at a corner",
            primitive.hollow ? 0.99 - 0.49 * static_cast<int>(corner) - 0.25 * primitive.fitted() : -1.0},
           {"share along", primitive.fitted() ? primitive.along : -1.0},
           {"share across", corner ? primitive.across : -1.0},
           {"corner", corner ? 0.5 + about * (0.25 * primitive.side_a + 0.125 * primitive.side_b) : -1.0}}};
}

inline int holes_of(const Hypothesis& hypothesis) {
  return static_cast<int>(std::count_if(hypothesis.primitives.begin(), hypothesis.primitives.end(),
                                        [](const Primitive& one) { return one.hollow; }));
}

/// Numbers of all primitives together, in any order.
inline std::array<Number, 4> numbers_of(const Hypothesis& hypothesis, const Prior::Settings& prior) {
  double nearest = 1e9;
  double covered = 0.0;
  for (int i = 0; i < hypothesis.primitives.size(); ++i) {
    covered += hypothesis.primitives[i].form.extent();
    for (int k = 0; k < i; ++k)
      nearest = std::min(nearest, std::hypot(hypothesis.primitives[i].form.x - hypothesis.primitives[k].form.x,
                                             hypothesis.primitives[i].form.y - hypothesis.primitives[k].form.y));
  }
  const double diagonal = std::hypot(prior.area.width, prior.area.depth);
  return {{{"primitives", (hypothesis.primitives.size() + 0.5) / (ShortList<Primitive>::kMost + 1)},
           {"holes", (holes_of(hypothesis) + 0.5) / (ShortList<Primitive>::kMost + 1)},
           {"least distance", hypothesis.primitives.size() > 1 ? nearest / diagonal : -1.0},
           {"extent", covered / (covered + 0.02)}}};
}

/// The mean change of hypotheses by moves: 0 if the moves keep the distribution. Each hypothesis is compared with
/// itself, so that few hypotheses show a change.
class Drift {
 public:
  explicit Drift(const Prior::Settings& prior) : prior_(prior) {}

  void add(const Hypothesis& before, const Hypothesis& after) {
    const auto one = sums(before);
    const auto other = sums(after);
    for (std::size_t i = 0; i < kSums; ++i) {
      const double change = other[i].value - one[i].value;
      names_[i] = one[i].name;
      sum_[i] += change;
      squares_[i] += change * change;
    }
  }

  /// The greatest mean change, in its standard errors, and the name of its sum.
  std::pair<double, std::string> deviation() const {
    std::pair<double, std::string> out{0.0, ""};
    for (std::size_t i = 0; i < kSums; ++i) {
      if (squares_[i] > 0.0) out = std::max(out, {std::abs(sum_[i]) / std::sqrt(squares_[i]), names_[i]});
    }
    return out;
  }

 private:
  static constexpr std::size_t kSums = 6 + kNumbers;
  /// Sums of the numbers over all primitives.
  std::array<Number, kSums> sums(const Hypothesis& hypothesis) const {
    std::array<Number, kSums> out{};
    const auto whole = numbers_of(hypothesis, prior_);
    std::copy(whole.begin(), whole.end(), out.begin());
    out[4] = {"none", hypothesis.primitives.size() == 0 ? 1.0 : 0.0};
    out[5] = {"small", 0.0};
    for (std::size_t i = 0; i < kNumbers; ++i) out[6 + i].name = numbers_of(Primitive(), prior_)[i].name;
    for (const Primitive& primitive : hypothesis.primitives) {
      out[5].value += primitive.form.a < prior_.min_width ? 1.0 : 0.0;
      const auto numbers = numbers_of(primitive, prior_);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        out[6 + i].value += numbers[i].value < 0.0 ? 0.0 : numbers[i].value - 0.5;
    }
    return out;
  }

  Prior::Settings prior_;
  std::array<const char*, kSums> names_{};
  std::array<double, kSums> sum_{}, squares_{};
};

}  // namespace palpate::footprints
