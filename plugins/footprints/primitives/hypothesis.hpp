// SPDX-License-Identifier: MIT
// The state of the model: a hypothesis of primitives on the desk, and its prior probability before any tap.
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
  double x = 0.0;  ///< of the centre
  double y = 0.0;
  double a = 0.0;       ///< half of the long axis
  double b = 0.0;       ///< half of the short axis, at most `a`
  double cosine = 1.0;  ///< of the angle from x to the long axis
  double sine = 0.0;

  bool contains(double px, double py) const {
    const double u = cosine * (px - x) + sine * (py - y);
    const double v = cosine * (py - y) - sine * (px - x);
    if (family == Family::box) return std::abs(u) <= a && std::abs(v) <= b;
    return u * u * (b * b) + v * v * (a * a) <= a * a * (b * b);
  }

  /// Returns the distance from a position inside to the rim, metres; negative outside. Exact for a box. For an ellipse
  /// it is exact to first order, and at most the distance to the circle about the ellipse.
  double depth(double px, double py) const;

  /// How far the form extends from its centre along x and along y, metres.
  double reach_x() const { return reach(cosine * a, sine * b); }
  double reach_y() const { return reach(sine * a, cosine * b); }
  /// How far it extends in a direction in which its half axes have these components.
  double reach(double along, double across) const {
    return family == Family::box ? std::abs(along) + std::abs(across) : std::sqrt(along * along + across * across);
  }
  /// Square metres.
  double extent() const { return (family == Family::box ? 4.0 : kPi) * a * b; }

  /// Turns the form about its centre, radians from x to y, or by an angle with this cosine and sine.
  void turn(double angle) { turn_by(math::cos(angle), math::sin(angle)); }
  void turn_by(double c, double s) { std::tie(cosine, sine) = std::pair(cosine * c - sine * s, sine * c + cosine * s); }
  /// Swaps the axes if `b` is the longer one; the covered region stays.
  void order_axes();
};

/// Draws a uniform position in a form.
Target drawn_inside(const Form& form, Random& random);

/// Whether two forms overlap, by their separating axes. True for some ellipses that pass close by each other, too.
bool overlap(const Form& one, const Form& other);

/// A box or an ellipse, perhaps with a hole, which may reach beyond it: a block or a cylinder, a ring, a U, an L.
struct Primitive {
  /// Where the hole is: anywhere; in the middle, with the same family and proportions; or at a corner of a box.
  enum class Fit { free, concentric, corner };

  Form form;
  Form hole;  ///< meaningful only if `hollow`
  bool hollow = false;
  Fit fit = Fit::free;
  // For a hole that is not free: its shares of the form's axes (`along` alone if concentric), and the sides of its
  // corner, 1 or -1.
  double along = 0.0, across = 0.0;
  int side_a = 1, side_b = 1;
  double density = 0.0;  ///< Prior::density() of the primitive, kept with it

  bool contains(double x, double y) const { return form.contains(x, y) && !(hollow && hole.contains(x, y)); }
  /// As Form::depth().
  double depth(double x, double y) const {
    const double in_form = form.depth(x, y);
    return hollow ? std::min(in_form, -hole.depth(x, y)) : in_form;
  }
  /// True for all positions within `margin` of the primitive, metres, and for some others beyond. The default is the
  /// distance within which a tap says much about the primitive.
  bool near(const Target& place, double margin = 0.03) const {
    const double dx = place.x - form.x;
    const double dy = place.y - form.y;
    return dx * dx + dy * dy <= 2.0 * (form.a * form.a + form.b * form.b + margin * margin);
  }

  /// Whether the hole follows the form; fit_hole() places such a hole.
  bool fitted() const { return hollow && fit != Fit::free; }
  void fit_hole();
  /// Swaps the form's axes if `b` is the longer one; the covered region stays.
  void order_axes();
};

/// A list of at most kMost elements in place.
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
  /// The last element takes the place of the removed one.
  void remove(int i) { (*this)[i] = (*this)[--size_]; }

 private:
  int size_ = 0;
  std::array<T, kMost> list_;
};

/// A displacement of all objects at once between two taps: a turn about the middle of the area, then a shift. Taps
/// before the push are seen where they would be made now.
struct Push {
  int before = 0;                         ///< number of taps before the push; 0: there was none
  double origin_x = 0.0, origin_y = 0.0;  ///< metres
  double dx = 0.0, dy = 0.0;              ///< metres
  double cosine = 1.0, sine = 0.0;        ///< of the turn from x to y

  explicit operator bool() const { return before > 0; }
  double angle() const { return math::atan2(sine, cosine); }

  /// Returns where a point of an object lies after the push, and the reverse.
  Target to_current(const Target& original) const;
  Target to_original(const Target& current) const;
  /// The same for primitives.
  Primitive to_current(Primitive original) const;
  Primitive to_original(Primitive current) const;
};

/// Primitives in no particular order, which may overlap. The objects cover the union of the primitives as it is after
/// the push.
struct Hypothesis {
  ShortList<Primitive> primitives;
  Push push;
  bool noisy = false;  ///< whether the positions of taps have noise

  bool contains(double x, double y) const {
    return std::any_of(primitives.begin(), primitives.end(), [=](const Primitive& one) { return one.contains(x, y); });
  }
};

/// The probability of primitives before any tap: a Poisson process of `expected` primitives, cut off above `most`. Each
/// lies wholly on the area, at a uniform position. Angle and logarithms of the half axes are uniform within the bounds.
/// `most_slender` holds for forms, not for free holes. Priors of push and noise: sampler.hpp.
/// Most ellipses are nearly round: the logarithm of the short half axis is uniform, the long one up to 6 % longer. Only
/// primitives twice as long as `min_width` have holes. A free hole has its centre on the primitive, and half axes from
/// half of `min_width` to the long half axis of the primitive. A fitted hole takes a tenth to nine tenths of the axes,
/// in the middle or, equally often for a box, at a corner.
class Prior {
 public:
  struct Settings {
    Area area;
    double min_width = 0.02;                 ///< metres
    double max_length = 0.22;                ///< metres
    double most_slender = 8.0;               ///< greatest ratio of length to width
    double ellipses = 0.3;                   ///< probability that a form is an ellipse, in (0, 1)
    double expected = 2.0;                   ///< mean number of primitives, above 0
    double round = 0.8;                      ///< probability that an ellipse is nearly round, in [0, 1)
    double hole_probability = 0.25;          ///< in [0, 1)
    double fitted = 0.8;                     ///< probability that a hole is not free, in [0, 1)
    int most = ShortList<Primitive>::kMost;  ///< 1 to kMost
  };

  /// Throws Error if the area is hardly larger than the smallest primitive.
  explicit Prior(const Settings& settings);

  const Settings& settings() const { return settings_; }

  /// Draws a hypothesis without a push and without noise.
  Hypothesis draw(Random& random) const;
  /// Draws a primitive, or one without a hole.
  Primitive draw_primitive(Random& random) const;
  Primitive draw_whole(Random& random) const;
  /// Gives the primitive a hole; its density is left as it was.
  void draw_hole(Primitive& primitive, Random& random) const;

  /// The probability that a primitive of this form has no hole.
  double whole_probability(const Form& form) const {
    return form.a >= settings_.min_width ? 1.0 - settings_.hole_probability : 1.0;
  }
  /// The density of a primitive in all centres, angles, shares and logarithms of half axes, up to a factor that all
  /// primitives share; 0 if it is impossible.
  double density(const Primitive& primitive) const;
  /// The density of the centre of a form, per square metre; 0 if the form does not fit there.
  double centre_density(const Form& form) const;

 private:
  /// Family, half axes up to `longest`, and direction; at the origin.
  Form draw_form(double longest, Random& random) const;
  double family(const Form& form) const;
  /// The density of ordered logarithms of half axes over this range, and of the direction.
  double axes(const Form& form, double range) const;
  double fitted_hole(const Primitive& primitive) const;
  double hole_centre_density(const Form& form, const Form& hole) const;
  bool in_bounds(const Form& form) const;
  /// Whether the form is within the bounds and smaller than the area.
  bool fits(const Form& form) const;

  Settings settings_;
  double longest_;  ///< half axis
  double range_;    ///< of logarithms of half axes
};

}  // namespace palpate::footprints
