// SPDX-License-Identifier: MIT
// That the objects were pushed, all alike, at some time between two touches.
#pragma once

#include "outline.hpp"

#include <palpate/math.hpp>
#include <palpate/types.hpp>

#include <cmath>

namespace palpate::footprints {

/// A displacement of the desk's objects, and when: a turn about a fixed origin, the middle of the area, and a shift.
/// What was touched before is seen where it would be touched now.
struct Push {
  int before = 0;                         ///< so many touches were made before it; 0: there was none
  double origin_x = 0.0, origin_y = 0.0;  ///< metres
  double dx = 0.0, dy = 0.0;              ///< metres
  double cosine = 1.0, sine = 0.0;        ///< of the turn from x to y

  explicit operator bool() const { return before > 0; }
  bool operator==(const Push& other) const {
    return before == other.before && dx == other.dx && dy == other.dy && cosine == other.cosine && sine == other.sine &&
           origin_x == other.origin_x && origin_y == other.origin_y;
  }
  double angle() const { return math::atan2(sine, cosine); }

  /// Where a place on the object, as it stood before, is now.
  Target now(const Target& then) const {
    const double x = then.x - origin_x;
    const double y = then.y - origin_y;
    return {origin_x + cosine * x - sine * y + dx, origin_y + sine * x + cosine * y + dy};
  }
  /// The way back.
  Target then(const Target& now) const {
    const double x = now.x - origin_x - dx;
    const double y = now.y - origin_y - dy;
    return {origin_x + cosine * x + sine * y, origin_y - sine * x + cosine * y};
  }

  /// The same of outlines.
  void carry_now(Outline& outline) const {
    each(outline, [this](Form& form) { carry(form, now(Target{form.x, form.y}), cosine, sine); });
  }
  void carry_then(Outline& outline) const {
    each(outline, [this](Form& form) { carry(form, then(Target{form.x, form.y}), cosine, -sine); });
  }

 private:
  static void carry(Form& form, const Target& to, double c, double s) {
    form.x = to.x;
    form.y = to.y;
    form.turn_by(c, s);
  }
  template <class Carry>
  static void each(Outline& outline, const Carry& carry) {
    for (Piece& piece : outline) {
      carry(piece.form);
      if (piece.hollow) carry(piece.hole);
    }
  }
};

}  // namespace palpate::footprints
