// SPDX-License-Identifier: MIT
// State of the model: a hypothesis of primitives on the desk, and its prior probability.
#pragma once

#include <palpate/math.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace palpate::footprints {

inline constexpr double kPi = 3.14159265358979323846;

/// A box or an ellipse. Lengths in metres, in the frame of the area.
struct Form {
  enum class Family { box, ellipse };
  Family family = Family::box;
  double x = 0.0;  ///< centre
  double y = 0.0;
  double a = 0.0;       ///< half of the long axis
  double b = 0.0;       ///< half of the short axis, at most `a`
  double cosine = 1.0;  ///< cosine of the angle from x to the long axis
  double sine = 0.0;

  bool contains(double px, double py) const {
    const double u = cosine * (px - x) + sine * (py - y);
    const double v = cosine * (py - y) - sine * (px - x);
    if (family == Family::box) return std::abs(u) <= a && std::abs(v) <= b;
    return u * u * (b * b) + v * v * (a * a) <= a * a * (b * b);
  }

  /// Returns the distance from an inner position to the rim, metres; negative outside. Exact for a box. For an ellipse
  /// it is exact to first order, and at most the distance to the circumscribed circle.
  double depth(double px, double py) const;

  /// Return the extent of the form from its centre along x and along y, metres.
  double reach_x() const { return reach(cosine * a, sine * b); }
  double reach_y() const { return reach(sine * a, cosine * b); }
  /// Returns the extent from the centre in a direction, metres. `along` and `across` are the components of the half
  /// axes `a` and `b` in this direction.
  double reach(double along, double across) const {
    return family == Family::box ? std::abs(along) + std::abs(across) : std::sqrt(along * along + across * across);
  }
  /// Returns the area in square metres.
  double extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

  /// turn(): Rotates the form about its centre by `angle` (radians, positive from x towards y). turn_by(): Does the
  /// same, given the cosine and sine of the angle.
  void turn(double angle) { turn_by(math::cos(angle), math::sin(angle)); }
  void turn_by(double c, double s) { std::tie(cosine, sine) = std::pair(cosine * c - sine * s, sine * c + cosine * s); }
  /// Swaps the axes if `b` is longer; the covered region is unchanged.
  void order_axes();
};

/// Returns a uniform random position in a form.
Target random_position(const Form& form, Random& random);

/// Returns whether two forms overlap, by separating axes. Also true for some ellipses that nearly touch.
bool overlap(const Form& one, const Form& other);

/// A box or an ellipse, optionally with a hole that may extend beyond it. Examples: block, cylinder, ring, U, L.
struct Primitive {
  /// Position of the hole: anywhere; in the middle, with the same family and proportions; or at a corner of a box.
  enum class HolePlacement { free, concentric, corner };

  Form form;
  Form hole;  ///< valid if `hollow`
  bool hollow = false;
  HolePlacement fit = HolePlacement::free;
  // Parameters of a fitted hole, which is concentric or at a corner. `along` and `across` are the size of its part
  // inside the form, as fractions of the form's axes (only `along` if concentric). `side_a` and `side_b`, +1 or -1,
  // select the corner of the form.
  double along = 0.0, across = 0.0;
  int side_a = 1, side_b = 1;
  double density = 0.0;  ///< cached Prior::density() of the primitive

  bool contains(double x, double y) const { return form.contains(x, y) && !(hollow && hole.contains(x, y)); }
  /// See Form::depth().
  double depth(double x, double y) const {
    const double in_form = form.depth(x, y);
    return hollow ? std::min(in_form, -hole.depth(x, y)) : in_form;
  }
  /// Returns true for all positions within `margin` metres of the primitive, and for some positions farther away. The
  /// default is the distance within which a tap is informative about the primitive.
  bool near(const Target& place, double margin = 0.03) const {
    const double dx = place.x - form.x;
    const double dy = place.y - form.y;
    return dx * dx + dy * dy <= 2.0 * (form.a * form.a + form.b * form.b + margin * margin);
  }

  /// Returns whether the hole is concentric or at a corner; fit_hole() computes such a hole from the form.
  bool fitted() const { return hollow && fit != HolePlacement::free; }
  void fit_hole();
  /// Swaps the form's axes if `b` is longer; the covered region is unchanged.
  void order_axes();
};

/// A list of at most kMost elements without heap memory.
template <class T>
class ShortList {
 public:
  static constexpr int kMost = 12;

  ShortList() = default;
  ShortList(const ShortList& other) { *this = other; }
  ShortList& operator=(const ShortList& other) {
    size_ = other.size_;
    std::copy(other.begin(), other.end(), begin());  // most lists are short
    return *this;
  }

  int size() const { return size_; }
  T& operator[](int i) { return list_[static_cast<std::size_t>(i)]; }
  const T& operator[](int i) const { return list_[static_cast<std::size_t>(i)]; }
  T* begin() { return list_.data(); }
  T* end() { return list_.data() + size_; }
  const T* begin() const { return list_.data(); }
  const T* end() const { return list_.data() + size_; }

  void clear() { size_ = 0; }
  T& add(const T& value) { return list_[static_cast<std::size_t>(size_++)] = value; }
  /// Removes element `i`; the last element takes its place.
  void remove(int i) { (*this)[i] = (*this)[--size_]; }

 private:
  int size_ = 0;
  std::array<T, kMost> list_;
};

/// Displacement of all objects at once between two taps: a rotation about the middle of the area, then a translation.
/// Earlier taps are moved to their positions after the push.
struct Push {
  int before = 0;                         ///< number of taps before the push; 0: no push
  double origin_x = 0.0, origin_y = 0.0;  ///< metres
  double dx = 0.0, dy = 0.0;              ///< metres
  double cosine = 1.0, sine = 0.0;        ///< cosine and sine of the rotation from x to y

  explicit operator bool() const { return before > 0; }
  double angle() const { return math::atan2(sine, cosine); }

  /// to_current(): Returns where a point of an object is after the push. to_original(): Returns where it was before.
  Target to_current(const Target& original) const;
  Target to_original(const Target& current) const;
  /// to_current(): Returns the primitive after the push. to_original(): Returns the primitive before it.
  Primitive to_current(Primitive original) const;
  Primitive to_original(Primitive current) const;
};

/// A set of primitives, in any order, which may overlap. `primitives` are at their positions after the push. The
/// objects cover their union.
struct Hypothesis {
  ShortList<Primitive> primitives;
  Push push;
  bool noisy = false;  ///< whether the positions of taps have noise

  bool contains(double x, double y) const {
    return std::any_of(primitives.begin(), primitives.end(), [=](const Primitive& one) { return one.contains(x, y); });
  }
};

/// Prior of hypotheses: a Poisson process of `expected` primitives, truncated at `most`. Each primitive is inside the
/// area, at a uniform position. Angle and logarithms of the half axes are uniform within the bounds. `most_slender`
/// limits the axes of forms, but not of free holes. Priors of push and noise are in sampler.hpp. Most ellipses are
/// nearly round: the logarithm of the short half axis is uniform, and the long half axis is up to 6 % longer. Only
/// primitives that are at least twice as long as `min_width` have holes. A free hole has its centre on the primitive,
/// and half axes from half of `min_width` to the long half axis of the primitive. The part of a fitted hole
/// (Primitive::fitted()) inside the form has 0.1 to 0.9 of the form's axes. In an ellipse, a fitted hole is concentric;
/// in a box, it is concentric or at a corner, with equal probability.
class Prior {
 public:
  struct Settings {
    Area area;
    double min_width = 0.02;                 ///< metres
    double max_length = 0.22;                ///< metres
    double most_slender = 8.0;               ///< largest ratio of length to width
    double ellipses = 0.3;                   ///< probability that a form is an ellipse, in (0, 1)
    double expected = 2.0;                   ///< mean number of primitives, above 0
    double round = 0.8;                      ///< probability that an ellipse is nearly round, in [0, 1)
    double hole_probability = 0.25;          ///< in [0, 1)
    double fitted = 0.8;                     ///< probability that a hole is fitted, in [0, 1)
    int most = ShortList<Primitive>::kMost;  ///< largest number of primitives, 1 to kMost
  };

  /// Throws Error if the area is too small for most draws of a primitive.
  explicit Prior(const Settings& settings);

  const Settings& settings() const { return settings_; }

  /// Draws a hypothesis without push and noise.
  Hypothesis draw(Random& random) const;
  /// Return a random primitive with or without a hole, and a random primitive without a hole.
  Primitive draw_primitive(Random& random) const;
  Primitive draw_whole(Random& random) const;
  /// Adds a random hole to the primitive; its density is not updated.
  void draw_hole(Primitive& primitive, Random& random) const;

  /// Returns the probability that a primitive of this form has no hole.
  double whole_probability(const Form& form) const {
    return form.a >= settings_.min_width ? 1.0 - settings_.hole_probability : 1.0;
  }
  /// Returns the density of a primitive with respect to its centre, its angle, the logarithms of all half axes, and the
  /// fractions of a fitted hole. The density is computed up to a factor that is the same for all primitives. It is 0 if
  /// the primitive is impossible.
  double density(const Primitive& primitive) const;
  /// Returns the density of a form's centre per square metre; 0 if the form does not fit there.
  double centre_density(const Form& form) const;

 private:
  /// Draws family, half axes up to `longest`, and direction; the centre is the origin.
  Form draw_form(double longest, Random& random) const;
  double family(const Form& form) const;
  /// Returns the joint density of the direction and of the logarithms of both half axes (a >= b). `range` is the length
  /// of the interval of these logarithms.
  double axes(const Form& form, double range) const;
  double fitted_hole(const Primitive& primitive) const;
  double hole_centre_density(const Form& form, const Form& hole) const;
  bool in_bounds(const Form& form) const;
  /// Returns whether the form is within the bounds and smaller than the area.
  bool fits(const Form& form) const;

  Settings settings_;
  double longest_;  ///< longest half axis, metres
  double range_;    ///< range of logarithms of half axes
};

}  // namespace palpate::footprints
