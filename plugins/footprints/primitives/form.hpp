// SPDX-License-Identifier: MIT
// What outlines are made of: boxes and ellipses of all directions.
#pragma once

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace palpate::footprints {

inline constexpr double kPi = 3.14159265358979323846;

/// A box or an ellipse. Lengths in metres, in the frame of the area.
struct Form {
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

  /// How far inside a place lies, metres; negative: outside. Exact of a box; of an ellipse to first order in the
  /// distance from the rim. Nowhere more than what is left to a circle about it: beyond that by some reach, it is at
  /// least that far outside.
  double depth(double px, double py) const {
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

  /// How far it reaches from its centre along x and along y.
  double reach_x() const { return reach(cosine * a, sine * b); }
  double reach_y() const { return reach(sine * a, cosine * b); }

  /// No place of it is farther from its centre.
  double radius() const { return std::sqrt(a * a + b * b); }

  /// Square metres.
  double extent() const;

  /// Turns it about its centre, radians from x to y.
  void turn(double angle) { turn_by(math::cos(angle), math::sin(angle)); }
  void turn_by(double c, double s) { std::tie(cosine, sine) = std::pair(cosine * c - sine * s, sine * c + cosine * s); }

  /// Names the longer axis `a` again, the shape stays.
  void order_axes();

  /// How far it reaches in a direction, given so much of its half axes along that.
  double reach(double along, double across) const {
    return family == Family::box ? std::abs(along) + std::abs(across) : std::sqrt(along * along + across * across);
  }
};

/// A form in single precision, as many others or many places at once are compared with it.
struct SingleForm {
  bool box;
  float x, y, a, b, cosine, sine;
};
inline SingleForm single(const Form& form) {
  return {form.family == Form::Family::box, static_cast<float>(form.x), static_cast<float>(form.y),
          static_cast<float>(form.a),       static_cast<float>(form.b), static_cast<float>(form.cosine),
          static_cast<float>(form.sine)};
}

/// Whether none of the lines along an axis of one, or across the way from one to the other, has them on either side.
bool no_line_between(const Form& one, const Form& other);

/// Whether two forms have a place in common; of ellipses that pass close by each other it may say so too early.
inline bool meet(const Form& one, const Form& other) {
  // The circles about them, and those in them, tell of most.
  const double dx = other.x - one.x;
  const double dy = other.y - one.y;
  const double square = dx * dx + dy * dy;
  const double within = one.b + other.b;
  if (square <= within * within) return true;
  const double beyond = one.a + other.a;
  return square <= 2.0 * beyond * beyond && no_line_between(one, other);
}

/// The cuts of a form along x: what they have in common is computed once.
struct Cuts {
  explicit Cuts(const Form& piece);

  /// Of cuts at whole numbers from `begin` on, before `end`: the whole numbers within, at least 0 and below `columns`,
  /// from one on and before another; none where that is not above it.
  void rows(int begin, int end, int columns, int* begins, int* ends) const;

  /// The same in other units: from these places on, in these steps.
  Cuts scaled(double from_x, double step_x, double from_y, double step_y) const {
    Cuts out = *this;
    out.x = (x - from_x) / step_x;
    out.y = (y - from_y) / step_y;
    out.reach /= step_y;
    for (int i = 0; i < 2; ++i) {
      out.slope[i] *= step_y / step_x;
      out.half[i] /= step_x;
    }
    return out;
  }

  Form::Family family;
  double x, y;
  double reach;  ///< no cut lies farther from the centre along y
  double slope[2] = {0.0, 0.0},
         half[2] = {0.0, 0.0};  ///< of the middle, and half widths: of a box for each pair of sides
};

}  // namespace palpate::footprints
