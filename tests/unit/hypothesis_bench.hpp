// SPDX-License-Identifier: MIT
// Hypotheses by the simplest definitions of what they contain, corners and foci; their primitives with an object tap;
// and numbers by which distributions of hypotheses are compared.
#pragma once

#include "primitives/hypothesis.hpp"

#include <palpate/footprint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace palpate::footprints {

using Point = std::array<double, 2>;

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

/// Nearer to a rim than that the two ways to say it may differ by rounding.
constexpr double kOnTheRim = 1e-12;

/// Whether a primitive holds a touch that has the label of an object.
inline bool touched(const Primitive& primitive, const std::vector<Touch>& touches) {
  return std::any_of(touches.begin(), touches.end(),
                     [&](const Touch& one) { return one.on && primitive.contains(one.place.x, one.place.y); });
}

/// The primitives that were touched and those that were not, together not more than there is room for.
struct Parts {
  Hypothesis seen, undiscovered;
};
inline Parts parts_of(const Hypothesis& hypothesis, const std::vector<Touch>& touches) {
  Parts out;
  for (const Primitive& primitive : hypothesis.primitives)
    (touched(primitive, touches) ? out.seen : out.undiscovered).primitives.add(primitive);
  return out;
}

/// Draws the touched primitives of the prior, up to its `most`; primitives come as often as the law of Poisson says.
inline Hypothesis drawn_and_touched(const Prior& prior, const std::vector<Touch>& touches, Random& random) {
  const Prior::Settings& settings = prior.settings();
  for (;;) {
    Hypothesis out;
    bool too_many = false;
    double time = -std::log(1.0 - random.uniform());
    for (; time < settings.expected && !too_many; time -= std::log(1.0 - random.uniform())) {
      const Primitive primitive = prior.draw_primitive(random);
      if (!touched(primitive, touches)) continue;
      too_many = out.primitives.size() == settings.most;
      if (!too_many) out.primitives.add(primitive);
    }
    if (!too_many) return out;
  }
}

/// The probabilities of 0 to `most` by the law of Poisson, of these alone.
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

/// That a sum of squares of `freedom` standard normal deviations is so large, as a standard normal deviation (Wilson
/// and Hilferty 1931).
inline double deviation_of_chi_square(double sum, double freedom) {
  const double spread = 2.0 / (9.0 * freedom);
  return (std::cbrt(sum / freedom) - (1.0 - spread)) / std::sqrt(spread);
}

/// The same of counts whose expectations are known. Counts that are too small go together.
inline double deviation_from(const std::vector<double>& expected, const std::vector<long>& counts) {
  double sum = 0.0;
  double cells = 0.0;
  double a = 0.0;
  double e = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    a += static_cast<double>(counts[i]);
    e += expected[i];
    if (e < 20.0) continue;
    sum += (a - e) * (a - e) / e;
    cells += 1.0;
    a = e = 0.0;
  }
  return deviation_of_chi_square(sum, cells - 1.0);
}

/// A number by which two distributions may differ, in [0, 1]; below 0 where there is none, as of a hole that is not.
struct Number {
  const char* name;
  double value;
};

inline double direction_of(const Form& form) {
  const double turns = std::atan2(form.sine, form.cosine) / kPi;
  return turns - std::floor(turns);
}

/// Every number that says what a primitive is, where it false_contact and how large.
inline constexpr std::size_t kNumbers = 18;
inline std::array<Number, kNumbers> numbers_of(const Primitive& primitive, const Prior::Settings& prior) {
  const Form& form = primitive.form;
  const Form& hole = primitive.hole;
  const double sizes = std::log(prior.max_length / prior.min_width);
  const auto size = [&](double half) { return std::log(2.0 * half / prior.min_width) / sizes; };
  const auto of_hole = [&](double value) { return primitive.hollow && !primitive.fitted() ? value : -1.0; };
  const bool corner = primitive.fitted() && primitive.fit == Primitive::Fit::corner;
  // A form that is turned about by half a circle is the same, with its hole at the other corner.
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

/// Numbers of all primitives together, whatever their order.
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

/// What moves that leave a distribution as it is do to its hypotheses on average: nothing. Each hypothesis is compared
/// with itself, so that little is needed to see more.
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

  /// The greatest mean change in standard errors of itself, and of which sum.
  std::pair<double, std::string> deviation() const {
    std::pair<double, std::string> out{0.0, ""};
    for (std::size_t i = 0; i < kSums; ++i) {
      if (squares_[i] > 0.0) out = std::max(out, {std::abs(sum_[i]) / std::sqrt(squares_[i]), names_[i]});
    }
    return out;
  }

 private:
  static constexpr std::size_t kSums = 6 + kNumbers;
  /// Over all primitives, how many have each number and what these come to, in so far as that says something.
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
