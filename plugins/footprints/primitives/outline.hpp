// SPDX-License-Identifier: MIT
// Outlines of all that is on the desk, as seen from above: any number of pieces, and what is thought of them before
// anything was touched.
#pragma once

#include "form.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::footprints {

/// A box or an ellipse, or one with a hole in it, which may reach beyond it: a block or a cylinder, a ring, a U, an L.
struct Piece {
  /// Where a hole is: anywhere; in the middle, of the same family and proportions; or at a corner of a box, along its
  /// sides.
  enum class Fit { free, concentric, corner };

  Form form;
  Form hole;  ///< of no meaning unless `hollow`
  bool hollow = false;
  Fit fit = Fit::free;
  // Of a hole that is not free: the shares of the form's axes that it takes (`along` alone where it is concentric), and
  // at which corner it is: on which sides, 1 or -1.
  double along = 0.0, across = 0.0;
  int side_a = 1, side_b = 1;
  double density = 0.0;  ///< see OutlinePrior, kept beside it

  bool contains(double x, double y) const { return form.contains(x, y) && !(hollow && hole.contains(x, y)); }
  /// How far inside of it, as of a form.
  double depth(double x, double y) const {
    const double in_form = form.depth(x, y);
    return hollow ? std::min(in_form, -hole.depth(x, y)) : in_form;
  }

  /// Whether a place is no farther from it than `margin`, or not much: metres, by default those within which a touch
  /// may tell of it.
  bool near(const Target& place, double margin = 0.03) const {
    const double dx = place.x - form.x;
    const double dy = place.y - form.y;
    return dx * dx + dy * dy <= 2.0 * (form.a * form.a + form.b * form.b + margin * margin);
  }

  bool fitted() const { return hollow && fit != Fit::free; }
  /// A hole that is not free follows the form.
  void fit_hole();
  /// Names the longer axis of the form `a` again; form and hole stay.
  void order_axes();
};

/// Pieces in no particular order, which may overlap: what one of them holds is on an object. None is an empty desk.
class Outline {
 public:
  static constexpr int kMost = 12;

  Outline() = default;
  Outline(const Outline& other) { *this = other; }
  Outline& operator=(const Outline& other) {
    size_ = other.size_;
    std::copy(other.begin(), other.end(), pieces_.begin());  // most have few
    return *this;
  }

  int size() const { return size_; }
  Piece& operator[](int i) { return pieces_[static_cast<std::size_t>(i)]; }
  const Piece& operator[](int i) const { return pieces_[static_cast<std::size_t>(i)]; }
  Piece* begin() { return pieces_.data(); }
  Piece* end() { return pieces_.data() + size_; }
  const Piece* begin() const { return pieces_.data(); }
  const Piece* end() const { return pieces_.data() + size_; }

  /// Those that are new are as they were left.
  void resize(int size) { size_ = size; }
  /// At most kMost of them.
  void add(const Piece& piece) { (*this)[size_++] = piece; }
  /// The last one takes its place.
  void remove(int i) { (*this)[i] = (*this)[--size_]; }

  bool contains(double x, double y) const {
    return std::any_of(begin(), end(), [=](const Piece& piece) { return piece.contains(x, y); });
  }

 private:
  int size_ = 0;
  std::array<Piece, kMost> pieces_;
};

/// What is thought of an outline before any touch. So many pieces are `expected`, by the law of Poisson up to `most`;
/// they know nothing of each other. A piece lies wholly on the
/// area, anywhere with equal probability; the logarithms of its half axes are uniform and independent, as far as they
/// keep the bounds and leave room to lie in. Of ellipses most are about round: their mean half axis is uniform so, and
/// the longer one up to 6 % above the other. A hole that is free has its centre on the piece, and such half axes from
/// half of `smallest` to the longer one of the piece; one that is fitted takes a tenth to nine tenths of the piece's
/// axes, in the middle or, as often of a box, at a corner. Only pieces twice as long as `smallest` have a hole.
class OutlinePrior {
 public:
  struct Settings {
    Area area;
    double smallest = 0.02;     ///< least width of a piece, metres
    double largest = 0.22;      ///< greatest length, metres
    double most_slender = 8.0;  ///< greatest ratio of length to width
    double ellipses = 0.3;      ///< probability that a piece or a hole is an ellipse, in (0, 1)
    double expected = 2.0;      ///< pieces, above 0
    double round = 0.8;         ///< probability that an ellipse is about round, in [0, 1)
    double hollow = 0.25;       ///< probability of a hole, in [0, 1)
    double fitted = 0.8;        ///< probability that a hole is not free, in [0, 1)
    int most = Outline::kMost;  ///< at least 1
  };

  /// Throws Error where the area has hardly any room for the smallest piece.
  explicit OutlinePrior(const Settings& settings);

  const Settings& settings() const { return settings_; }

  Outline draw(Random& random) const;
  /// A piece without a hole; and gives it one, but for the density.
  Piece draw_piece(Random& random) const;
  void draw_hole(Piece& piece, Random& random) const;
  /// One that may have a hole.
  Piece draw_piece_or_hollow(Random& random) const;

  /// That a piece has no hole.
  double whole(const Form& form) const { return form.a >= settings_.smallest ? 1.0 - settings_.hollow : 1.0; }
  /// Of a piece with all that it has, in its centres, angles and logarithms of half axes; 0 where it is impossible.
  double density(const Piece& piece) const;
  /// The part of it that is the density of the centre of the form, or of the hole, per square metre.
  double centre_density(const Form& form) const;
  double hole_centre_density(const Form& form, const Form& hole) const;

 private:
  /// Family, half axes up to `longest` and direction, at the origin.
  Form draw_form(double longest, Random& random) const;
  double family(const Form& form) const;
  /// Of ordered logarithms of half axes over such a range, and of a direction.
  double axes(const Form& form, double range) const;
  double fitted_hole(const Piece& piece) const;
  /// Whether it keeps the bounds of lengths and widths, and, to fit, whether there is room for it.
  bool in_bounds(const Form& form) const;
  bool fits(const Form& form) const;

  Settings settings_;
  double longest_;     ///< of half axes
  double range_;       ///< of their logarithms
  double form_ = 0.0;  ///< one over the share of all forms that fits
};

}  // namespace palpate::footprints
