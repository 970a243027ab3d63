// SPDX-License-Identifier: MIT
// The simple solids that a belief over space is made of, and what a touch along a line has to do with one.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <array>
#include <limits>

namespace palpate {

/// Where a line meets what it does not meet; and 180 degrees, in radian.
inline constexpr double kNoHit = std::numeric_limits<double>::infinity();
inline constexpr double kHalfTurn = 3.14159265358979323846;

/// The part of a line between two distances from its origin, metres; empty where `begin` > `end`. Beside each the
/// cosine between line and surface normal there, without its sign.
struct Chord {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
  double begin_cosine = 1.0;
  double end_cosine = 1.0;
  bool empty() const { return begin > end; }
};

/// A box, a cylinder or an ellipsoid at any pose, whole or a vessel: hollowed out from its upper end, with a wall all
/// around and below. Of an ellipsoid a vessel keeps the lower half: a bowl. Lengths in metres, relative to the desk.
struct Primitive {
  enum class Form { box, cylinder, ellipsoid };
  Form form = Form::box;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();      ///< from its own frame, in which up is the third axis
  Eigen::Vector3d half = Eigen::Vector3d::Constant(0.05);  ///< half its extents in that frame
  double wall = 0.0;                                       ///< thickness; 0 where it is whole

  bool hollow() const { return wall > 0.0; }
  double volume() const;  ///< of what it encloses, the hollow included, cubic metres
  /// How far that reaches from its centre, along a direction of its own frame.
  double reach(const Eigen::Vector3d& own) const;

  /// Which parts of a line lie in the solid, in their order: none, one or, where it passes through the hollow, two.
  std::array<Chord, 2> inside(const Line& line) const;
  /// Where a line first meets it, infinity where it does not.
  double first_intersection(const Line& line) const;

  /// By how much a line that passes through would have to be moved aside to pass by, metres, whatever is hollow: 0 or
  /// less where it does pass by; `most` if it is more. An upper bound, of boxes exact, of others nearly.
  double aside(const Line& line, double most = kNoHit) const;

  /// About how far a point is outside (or, negative, inside), metres: exact at the surface, of one sign on either side
  /// of it, and of a whole box or cylinder exact everywhere; never more than the distance but for ellipsoids.
  double distance(const Eigen::Vector3d& point) const;
};

}  // namespace palpate
