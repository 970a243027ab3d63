// SPDX-License-Identifier: MIT
// Outlines of objects as seen from above: a piece, two pieces, or a piece from which another is taken.
#pragma once

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace palpate::footprints {

inline constexpr double kPi = 3.14159265358979323846;

/// A box or an ellipse. Lengths in metres, in the frame of the area.
struct Piece {
  enum class Family { box, ellipse };
  Family family = Family::box;
  double x = 0.0;  ///< of the centre
  double y = 0.0;
  double a = 0.0;       ///< half of the long axis
  double b = 0.0;       ///< half of the short axis, at most `a`
  double cosine = 1.0;  ///< of the angle from x to the long axis: as a direction it needs no trigonometry to be asked
  double sine = 0.0;

  bool contains(double px, double py) const {
    const double u = cosine * (px - x) + sine * (py - y);
    const double v = cosine * (py - y) - sine * (px - x);
    if (family == Family::box) return std::abs(u) <= a && std::abs(v) <= b;
    return u * u * (b * b) + v * v * (a * a) <= a * a * (b * b);
  }

  /// How far inside a place lies, metres; negative: outside. Exact within a box; of an ellipse and outside of corners
  /// to first order in the distance from the rim.
  double depth(double px, double py) const {
    const double u = cosine * (px - x) + sine * (py - y);
    const double v = cosine * (py - y) - sine * (px - x);
    if (family == Family::box) return std::min(a - std::abs(u), b - std::abs(v));
    const double q = std::sqrt(u * u * (b * b) + v * v * (a * a)) / (a * b);
    const double slope = std::sqrt(u * u * (b * b * b * b) + v * v * (a * a * a * a)) / (a * a * b * b);
    return slope > 0.0 ? q * (1.0 - q) / slope : b;
  }

  /// How far it reaches from its centre along x and along y.
  double reach_x() const { return reach(cosine * a, sine * b); }
  double reach_y() const { return reach(sine * a, cosine * b); }

  /// Square metres.
  double extent() const;

  /// See Cuts.
  std::pair<double, double> cut(double py) const;

  /// Turns it about its centre, radians from x to y.
  void turn(double angle) { turn_by(std::cos(angle), std::sin(angle)); }
  void turn_by(double c, double s) { std::tie(cosine, sine) = std::pair(cosine * c - sine * s, sine * c + cosine * s); }

  /// Names the longer axis `a` again, the shape stays.
  void order_axes();

 private:
  double reach(double along, double across) const {
    return family == Family::box ? std::abs(along) + std::abs(across) : std::sqrt(along * along + across * across);
  }
};

/// The cuts of a piece along x: what they have in common is computed once.
class Cuts {
 public:
  explicit Cuts(const Piece& piece);

  /// The ends along x of the cut at `py`; the first is larger where there is none.
  std::pair<double, double> at(double py) const {
    const double dy = py - y_;
    if (family_ == Piece::Family::box) {
      if (std::abs(dy) > reach_) return {1.0, 0.0};
      return {x_ + std::max(slope_[0] * dy - half_[0], slope_[1] * dy - half_[1]),
              x_ + std::min(slope_[0] * dy + half_[0], slope_[1] * dy + half_[1])};
    }
    const double rest = 1.0 - dy * dy / (reach_ * reach_);
    if (rest < 0.0) return {1.0, 0.0};
    const double middle = x_ + slope_[0] * dy;
    const double half = half_[0] * std::sqrt(rest);
    return {middle - half, middle + half};
  }

  /// No cut lies farther from the centre along y.
  double y() const { return y_; }
  double reach() const { return reach_; }

  /// The same in other units: from these places on, in these steps.
  Cuts scaled(double from_x, double step_x, double from_y, double step_y) const {
    Cuts out = *this;
    out.x_ = (x_ - from_x) / step_x;
    out.y_ = (y_ - from_y) / step_y;
    out.reach_ /= step_y;
    for (int i = 0; i < 2; ++i) {
      out.slope_[i] *= step_y / step_x;
      out.half_[i] /= step_x;
    }
    return out;
  }

 private:
  Piece::Family family_;
  double x_, y_;
  double reach_;
  double slope_[2] = {0.0, 0.0},
         half_[2] = {0.0, 0.0};  ///< of the middle, and half widths: of a box for each pair of sides
};

/// One piece is a block or a cylinder. Two make an L, a T, or objects that lie apart. A piece without another is a
/// ring, a U, or once more an L.
struct Outline {
  enum class Kind { one, two, without };
  Kind kind = Kind::one;
  Piece first;
  Piece second;  ///< of no meaning where the kind is `one`

  bool contains(double x, double y) const {
    const bool in_first = first.contains(x, y);
    if (kind == Kind::one) return in_first;
    return kind == Kind::two ? in_first || second.contains(x, y) : in_first && !second.contains(x, y);
  }

  /// How far inside of it, as of a piece.
  double depth(double x, double y) const {
    const double in_first = first.depth(x, y);
    if (kind == Kind::one) return in_first;
    const double in_second = second.depth(x, y);
    return kind == Kind::two ? std::max(in_first, in_second) : std::min(in_first, -in_second);
  }
};

/// What is thought of an outline before any touch. A piece lies wholly on the area, anywhere with equal probability;
/// the logarithms of its half axes are uniform and independent, as far as they keep the bounds and leave room to lie
/// in. The second of two pieces is like the first. A piece that is taken from another has its centre on that one, and
/// half axes whose logarithms are uniform from half of `smallest` to the longer one of that piece.
class OutlinePrior {
 public:
  struct Settings {
    Area area;
    double smallest = 0.02;     ///< least width of a piece, metres
    double largest = 0.22;      ///< greatest length, metres
    double most_slender = 8.0;  ///< greatest ratio of length to width
    double ellipses = 0.3;      ///< probability that a piece is an ellipse, in (0, 1)
    double two = 0.35;          ///< probability of two pieces
    double without = 0.35;      ///< probability of a piece without another
  };

  explicit OutlinePrior(const Settings& settings) : settings_(settings) {}

  const Area& area() const { return settings_.area; }

  /// Throws Error where the area has no room for the smallest piece.
  Outline draw(Random& random) const;

  /// A second piece by the prior, given the first.
  Piece draw_second(Outline::Kind kind, const Piece& first, Random& random) const;

  /// The density of an outline up to a factor that depends on its kind alone, in the centres, angles and logarithms of
  /// the half axes of its pieces; 0 where it is impossible.
  double density(const Outline& outline) const;

  /// The part of it that is the density of the second piece's centre, per square metre; 0 where that is impossible.
  double second_centre_density(const Outline& outline) const;

  /// How much more probable `kind` is than one piece.
  double odds(Outline::Kind kind) const;

 private:
  Piece draw_piece(Random& random) const;
  /// Family, half axes up to `longest` and direction, of a piece at the origin.
  Piece draw_form(double longest, Random& random) const;
  double centre_density(const Piece& piece) const;
  double family(const Piece& piece) const;

  Settings settings_;
};

}  // namespace palpate::footprints
