// SPDX-License-Identifier: MIT
// An object with a random smooth outline, which has lobes and is bent, and with a random smooth top. It is used to test
// strategies on objects for which they were not developed.
#include "prism/prism.hpp"

#include <palpate/math.hpp>

#include <array>
#include <vector>

namespace palpate::shapes {

struct RandomOutlineOptions : Options {
  double length = 0.14;
  double height = 0.05;
  double roughness = 0.5;
  std::int64_t number = 0;

  void list(Fields& fields) override {
    fields.real(length,
                Field("length", "longer side of the rectangle around the outline").in(Unit::metre).at_least(0.05));
    fields.real(height, Field("height",
                              "height of the top above the desk, in the middle of the rectangle around the outline. "
                              "The wave of the top is not included")
                            .in(Unit::metre)
                            .at_least(0.02));
    fields.real(roughness,
                Field("roughness", "roughness of the outline, from 0 (a bent ellipse) to 1 (deep lobes)").within(0, 1));
    fields.integer(
        number,
        Field("number", "index of the outline. The seed of the run and this index determine the outline").at_least(0));
  }
};

constexpr double kTurn = 2.0 * 3.14159265358979323846;
constexpr double kLowestTop = 0.015;   ///< metres; clearly above the height up to which contacts count as desk
constexpr double kCore = 0.01;         ///< metres; radius of a disk that every outline contains
constexpr double kClear = 1e-9;        ///< metres; the exit of a line is searched at least this far after its entry
constexpr std::size_t kCorners = 240;  ///< number of corners; for an outline of 14 cm length, edges are 2 mm long

/// Returns a uniform random number between two limits.
double between(double low, double high, Random& random) { return low + (high - low) * random.uniform(); }

/// Returns the left, right, lower and upper end of the bounding rectangle of an outline.
std::array<double, 4> bounds(const Outline& outline) {
  std::array<double, 4> out{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Point& p : outline)
    out = {std::min(out[0], p[0]), std::max(out[1], p[0]), std::min(out[2], p[1]), std::max(out[3], p[1])};
  return out;
}

/// Returns a star-shaped outline around the origin, stretched along x. The logarithm of its radius is a function of the
/// angle: a short Fourier series with decreasing amplitudes.
Outline star(double roughness, Random& random) {
  constexpr int kLobes = 5;
  std::array<double, kLobes + 1> amplitude{}, phase{};
  for (int n = 2; n <= kLobes; ++n) {
    amplitude[n] = roughness * between(0.3, 1.4, random) / n;
    phase[n] = kTurn * random.uniform();
  }
  const double stretch = between(1.0, 2.2, random);
  Outline out;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const double angle = kTurn * static_cast<double>(i) / kCorners;
    double logarithm = 0.0;
    for (int n = 2; n <= kLobes; ++n) logarithm += amplitude[n] * math::cos(n * angle + phase[n]);
    const double radius = math::exp(logarithm);
    out.push_back({stretch * radius * math::cos(angle), radius * math::sin(angle)});
  }
  return out;
}

/// Bends the x axis to an arc of a circle. The map is injective on a star, so no edges cross afterwards. The reasons:
/// the centre of the circle is farther from the axis than any point of the star, and the arc is less than a full
/// circle.
void bend(Outline& outline, Random& random) {
  const auto [left, right, low, high] = bounds(outline);
  const double most = std::min(0.75 / std::max(-low, high), 0.3 * kTurn / std::max(-left, right));
  const double curvature = most * between(-1.0, 1.0, random);
  if (std::abs(curvature) < 1e-3) return;
  for (Point& p : outline) {
    const double radius = 1.0 / curvature - p[1];
    p = {radius * math::sin(curvature * p[0]), 1.0 / curvature - radius * math::cos(curvature * p[0])};
  }
}

/// Scales an outline so that the longer side of its bounding rectangle has this length. Rotates it so that this side is
/// along x.
void scale(Outline& outline, double length) {
  const auto [left, right, low, high] = bounds(outline);
  const bool across = high - low > right - left;
  const double factor = length / std::max(right - left, high - low);
  for (Point& p : outline) p = across ? Point{factor * p[1], -factor * p[0]} : Point{factor * p[0], factor * p[1]};
}

/// Draws an outline around the origin. An outline without a core (a disk of radius kCore) is drawn again with less
/// roughness. A bent ellipse always has a core, so the drawing ends.
Outline random_outline(const RandomOutlineOptions& o, Random& random) {
  for (double roughness = o.roughness;; roughness *= 0.9) {
    Outline out = star(roughness, random);
    bend(out, random);
    scale(out, o.length);
    if (std::any_of(out.begin(), out.end(), [](const Point& p) { return math::hypot(p[0], p[1]) < kCore; })) continue;
    const auto [left, right, low, high] = bounds(out);
    for (Point& p : out) p = {p[0] - (left + right) / 2, p[1] - (low + high) / 2};
    return out;
  }
}

class RandomOutline final : public Shape {
 public:
  using Options = RandomOutlineOptions;
  RandomOutline(const Options& o, const Context& context)
      : RandomOutline(o, context.random("shape/random_outline", static_cast<std::uint64_t>(o.number))) {}

  double top(double s, double t) const override {
    return contains(outline_, {s, t}) ? middle_ + slope_[0] * s + slope_[1] * t + swell_ * math::cos(phase(s, t))
                                      : -kInfinity;
  }

  double first_intersection(const Line& line) const override {
    Interval between;
    between.clip(line.origin.z(), line.direction.z(), 0.0, middle_ + relief_);
    if (between.empty()) return kInfinity;
    const auto [begin, end] = between;
    const Point direction{line.direction.x(), line.direction.y()};
    // A nearly vertical line intersects the top at one position.
    if (std::abs(direction[0]) + std::abs(direction[1]) < 1e-12) {
      const double height = top(line.origin.x() + begin * direction[0], line.origin.y() + begin * direction[1]);
      if (line.direction.z() > 0.0) return height > 0.0 ? begin : kInfinity;
      return (height - line.origin.z()) / line.direction.z();
    }
    for (const LineInterval& seen : seen_from_above(line)) {
      const double hit = change(line, std::max(begin, seen.begin), std::min(end, seen.end), 1.0);
      if (hit < kInfinity) return hit;
    }
    return kInfinity;
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    Interval between;
    between.clip(line.origin.z(), line.direction.z(), 0.0, middle_ + relief_);
    if (between.empty() || std::abs(line.direction.x()) + std::abs(line.direction.y()) < 1e-12)
      return Shape::intervals(line);
    std::vector<LineInterval> all;
    for (const LineInterval& seen : seen_from_above(line)) {
      const double end = std::min(between.end, seen.end);
      double from = std::max(between.begin, seen.begin);
      while (from < end) {
        const double in = change(line, from, end, 1.0);
        if (!(in < end)) break;
        // The search for the exit starts a little after the entry, because it would otherwise find the entry again.
        const double out = std::min(end, change(line, in + kClear, end, -1.0));
        if (out > in) all.push_back({in, out});
        from = out + kClear;
      }
    }
    return joined(std::move(all));
  }

  /// Perpendicular to the direction of the wave, the top is straight. The support point is therefore on the outline.
  double support(const Vector3d& direction) const override {
    const double up = std::max(0.0, direction.z());
    const Point rise{direction.x() + up * slope_[0], direction.y() + up * slope_[1]};
    const auto reach = [&](double s, double t, double phase) {
      return rise[0] * s + rise[1] * t + up * (middle_ + swell_ * math::cos(phase));
    };
    double most = -kInfinity;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      const Point& a = outline_[i];
      const Point& b = next(outline_, i);
      const double before = phase(a[0], a[1]);
      most = std::max(most, reach(a[0], a[1], before));
      // Between two corners, a maximum is where the derivative vanishes near a crest of the wave.
      const double turn = phase(b[0], b[1]) - before;
      const double sine = (rise[0] * (b[0] - a[0]) + rise[1] * (b[1] - a[1])) / (up * swell_ * turn);
      if (!(std::abs(sine) <= 1.0)) continue;
      const double crest = math::asin(sine);
      const double there = crest + kTurn * std::round((before + turn / 2 - crest) / kTurn);
      const double share = (there - before) / turn;
      if (share < 0.0 || share > 1.0) continue;
      most = std::max(most, reach(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), there));
    }
    return most;
  }

 private:
  RandomOutline(const Options& o, Random random)
      : outline_(random_outline(o, random)), middle_(o.height), relief_(o.height - kLowestTop) {
    double farthest = 0.0;
    for (const Point& p : outline_) farthest = std::max(farthest, math::hypot(p[0], p[1]));
    // The sum of slope and wave is at most the relief, so the top stays above kLowestTop.
    const double steepness = between(0.1, 0.6, random) * relief_ / farthest;
    swell_ = between(0.1, 0.4, random) * relief_;
    const double uphill = kTurn * random.uniform();
    const double onwards = kTurn * random.uniform();
    const double rate = kTurn / (between(0.5, 1.0, random) * o.length);
    slope_ = {steepness * math::cos(uphill), steepness * math::sin(uphill)};
    wave_ = {rate * math::cos(onwards), rate * math::sin(onwards)};
    phase_ = kTurn * random.uniform();
  }

  /// Returns the phase of the wave on the top, radians.
  double phase(double s, double t) const { return wave_[0] * s + wave_[1] * t + phase_; }

  /// Returns the parts of the line that are within the outline as seen from above. They are between crossings 1 and 2,
  /// 3 and 4, and so on.
  std::vector<LineInterval> seen_from_above(const Line& line) const {
    std::array<double, kCorners> crossings{};
    std::size_t count = 0;
    visit_crossings(outline_, {line.origin.x(), line.origin.y()}, {line.direction.x(), line.direction.y()},
                    [&](double x) { crossings[count++] = x; });
    std::sort(crossings.begin(), crossings.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<LineInterval> out;
    for (std::size_t i = 0; i + 1 < count; i += 2) out.push_back({crossings[i], crossings[i + 1]});
    return out;
  }

  /// Returns the first position in [from, to] at which the line crosses the top. With `sign` 1 this is the first point
  /// that is not above the top, with `sign` -1 the first point that is not below it. Returns infinity if there is none.
  /// Between `from` and `to`, the line must be within the outline as seen from above. Each step goes to the root of a
  /// parabola that has the largest curvature of the top. No step can therefore pass the crossing. Near the crossing,
  /// the steps converge like those of Newton's method.
  double change(const Line& line, double from, double to, double sign) const {
    const Vector3d& u = line.direction;
    const double rate = wave_[0] * u.x() + wave_[1] * u.y();
    const double curvature = swell_ * rate * rate;
    for (double x = from; x <= to;) {
      const Vector3d p = line.origin + x * u;
      const double at = phase(p.x(), p.y());
      const double clear = sign * (p.z() - (middle_ + slope_[0] * p.x() + slope_[1] * p.y() + swell_ * math::cos(at)));
      if (clear <= 0.0) return x;
      const double slope = sign * (u.z() - slope_[0] * u.x() - slope_[1] * u.y() + swell_ * rate * math::sin(at));
      if (slope >= 0.0 && curvature == 0.0) return kInfinity;
      const double root = std::sqrt(slope * slope + 2 * curvature * clear);
      const double next = x + (slope < 0.0 ? 2 * clear / (root - slope) : (root + slope) / curvature);
      if (!(next > x)) return x;
      x = next;
    }
    return kInfinity;
  }

  Outline outline_;
  double middle_, relief_;  ///< the top is between middle - relief and middle + relief
  double swell_ = 0.0, phase_ = 0.0;
  Point slope_{}, wave_{};
};

PALPATE_PLUGIN(Shape, RandomOutline, "random_outline", "smooth random outline and top, drawn from the seed")

}  // namespace palpate::shapes
