// SPDX-License-Identifier: MIT
// Outlines by the simplest ways to say what they hold: corners and foci; which of their pieces were touched; and in
// numbers, by which it is seen whether two ways to draw outlines are one distribution.
#pragma once

#include "primitives/outline.hpp"

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

/// Nearer to a rim than that the two ways to say it may differ by rounding.
constexpr double kOnTheRim = 1e-12;

/// Whether a piece holds a touch that has the label of an object.
inline bool touched(const Piece& piece, const std::vector<Touch>& touches) {
  return std::any_of(touches.begin(), touches.end(),
                     [&](const Touch& one) { return one.on && piece.contains(one.place.x, one.place.y); });
}

/// The pieces that were touched and those that were not, together not more than there is room for.
struct Parts {
  Outline seen, unseen;
};
inline Parts parts_of(const Outline& outline, const std::vector<Touch>& touches) {
  Parts out;
  for (const Piece& piece : outline) (touched(piece, touches) ? out.seen : out.unseen).add(piece);
  return out;
}

/// Draws the touched pieces of the prior, up to its `most`; pieces come as often as the law of Poisson says.
inline Outline drawn_and_touched(const OutlinePrior& prior, const std::vector<Touch>& touches, Random& random) {
  const OutlinePrior::Settings& settings = prior.settings();
  for (;;) {
    Outline out;
    bool too_many = false;
    double time = -std::log(1.0 - random.uniform());
    for (; time < settings.expected && !too_many; time -= std::log(1.0 - random.uniform())) {
      const Piece piece = prior.draw_piece_or_hollow(random);
      if (!touched(piece, touches)) continue;
      too_many = out.size() == settings.most;
      if (!too_many) out.add(piece);
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

/// Every number that says what a piece is, where it lies and how large.
inline constexpr std::size_t kNumbers = 18;
inline std::array<Number, kNumbers> numbers_of(const Piece& piece, const OutlinePrior::Settings& prior) {
  const Form& form = piece.form;
  const Form& hole = piece.hole;
  const double sizes = std::log(prior.largest / prior.smallest);
  const auto size = [&](double half) { return std::log(2.0 * half / prior.smallest) / sizes; };
  const auto of_hole = [&](double value) { return piece.hollow && !piece.fitted() ? value : -1.0; };
  const bool corner = piece.fitted() && piece.fit == Piece::Fit::corner;
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
           {"a hole", piece.hollow ? 0.99 : 0.01},
           {"log a of hole", of_hole(std::log(2.0 * hole.a / prior.smallest + 1e-9) / sizes)},
           {"slenderness of hole", of_hole(std::log(hole.a / hole.b) / sizes)},
           {"direction of hole", of_hole(direction_of(hole))},
           {"place of hole", of_hole(0.5 + 0.5 * (form.cosine * dx + form.sine * dy) / form.a)},
           {"a hole at a corner", piece.hollow ? 0.99 - 0.49 * static_cast<int>(corner) - 0.25 * piece.fitted() : -1.0},
           {"share along", piece.fitted() ? piece.along : -1.0},
           {"share across", corner ? piece.across : -1.0},
           {"corner", corner ? 0.5 + about * (0.25 * piece.side_a + 0.125 * piece.side_b) : -1.0}}};
}

inline int holes_of(const Outline& outline) {
  return static_cast<int>(std::count_if(outline.begin(), outline.end(), [](const Piece& one) { return one.hollow; }));
}

/// Numbers of all pieces together, whatever their order.
inline std::array<Number, 4> numbers_of(const Outline& outline, const OutlinePrior::Settings& prior) {
  double nearest = 1e9;
  double covered = 0.0;
  for (int i = 0; i < outline.size(); ++i) {
    covered += outline[i].form.extent();
    for (int k = 0; k < i; ++k)
      nearest =
          std::min(nearest, std::hypot(outline[i].form.x - outline[k].form.x, outline[i].form.y - outline[k].form.y));
  }
  const double diagonal = std::hypot(prior.area.width, prior.area.depth);
  return {{{"pieces", (outline.size() + 0.5) / (Outline::kMost + 1)},
           {"holes", (holes_of(outline) + 0.5) / (Outline::kMost + 1)},
           {"least distance", outline.size() > 1 ? nearest / diagonal : -1.0},
           {"extent", covered / (covered + 0.02)}}};
}

/// What moves that leave a distribution as it is do to its outlines on average: nothing. Each outline is compared with
/// itself, so that little is needed to see more.
class Drift {
 public:
  explicit Drift(const OutlinePrior::Settings& prior) : prior_(prior) {}

  void add(const Outline& before, const Outline& after) {
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
  /// Over all pieces, how many have each number and what these come to, in so far as that says something.
  std::array<Number, kSums> sums(const Outline& outline) const {
    std::array<Number, kSums> out{};
    const auto whole = numbers_of(outline, prior_);
    std::copy(whole.begin(), whole.end(), out.begin());
    out[4] = {"none", outline.size() == 0 ? 1.0 : 0.0};
    out[5] = {"small", 0.0};
    for (std::size_t i = 0; i < kNumbers; ++i) out[6 + i].name = numbers_of(Piece(), prior_)[i].name;
    for (const Piece& piece : outline) {
      out[5].value += piece.form.a < prior_.smallest ? 1.0 : 0.0;
      const auto numbers = numbers_of(piece, prior_);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        out[6 + i].value += numbers[i].value < 0.0 ? 0.0 : numbers[i].value - 0.5;
    }
    return out;
  }

  OutlinePrior::Settings prior_;
  std::array<const char*, kSums> names_{};
  std::array<double, kSums> sum_{}, squares_{};
};

}  // namespace palpate::footprints
