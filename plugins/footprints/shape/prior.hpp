// SPDX-License-Identifier: MIT
// What is thought of an outline before any touch.
#pragma once

#include "outline.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

namespace palpate::footprints {

/// A piece lies wholly on the area, anywhere with equal probability; the logarithms of its
/// half axes are uniform and independent, as far as they keep the bounds and leave room to lie in. The second of two
/// pieces is like the first. A piece that is taken from another has its centre on that one, and half axes whose
/// logarithms are uniform from half of `smallest` to the longer one of that piece.
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
