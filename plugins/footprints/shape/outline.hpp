// SPDX-License-Identifier: MIT
// Outlines of simple objects as seen from above: oriented boxes and ellipses.
#pragma once

#include <palpate/types.hpp>

#include <utility>

namespace palpate::footprints {

/// A box or an ellipse. Lengths in metres, in the frame of the area.
struct Outline {
  enum class Family { box, ellipse };
  Family family = Family::box;
  double x = 0.0;  ///< of the centre
  double y = 0.0;
  double angle = 0.0;  ///< from x to the long axis, radians
  double a = 0.0;      ///< half of the long axis
  double b = 0.0;      ///< half of the short axis, at most `a`
};

/// The same prepared for many questions: what only depends on the outline is computed once.
class Region {
 public:
  explicit Region(const Outline& outline);

  bool contains(double x, double y) const {
    const double u = (cosine_ * (x - x_) + sine_ * (y - y_)) * per_a_;
    const double v = (cosine_ * (y - y_) - sine_ * (x - x_)) * per_b_;
    return ellipse_ ? u * u + v * v <= 1.0 : (u <= 1.0 && u >= -1.0 && v <= 1.0 && v >= -1.0);
  }

  /// How far it reaches from its centre along x and along y.
  double reach_x() const { return reach_x_; }
  double reach_y() const { return reach_y_; }

  /// Whether all of it lies on the area.
  bool within(const Target& size) const {
    return x_ >= reach_x_ && x_ + reach_x_ <= size.x && y_ >= reach_y_ && y_ + reach_y_ <= size.y;
  }

  /// The ends along x of its cut at `y`; the first is larger where there is none.
  std::pair<double, double> cut(double y) const;

 private:
  double x_, y_, cosine_, sine_, a_, b_, per_a_, per_b_;
  double reach_x_, reach_y_;
  bool ellipse_;
};

}  // namespace palpate::footprints
