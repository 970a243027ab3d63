// SPDX-License-Identifier: MIT
// Simple solids, of which assemblies consist, and their intersections with lines.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <array>
#include <limits>

namespace palpate {

/// Value that stands for the distance to a solid if a line misses it; and 180 degrees in radians.
inline constexpr double kNoHit = std::numeric_limits<double>::infinity();
inline constexpr double kHalfTurn = 3.14159265358979323846;

/// The part of a line between two distances from its origin, metres; empty if `begin` > `end`. The cosines are the
/// absolute cosines between the line and the surface normals at both ends.
struct Chord {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
  double begin_cosine = 1.0;
  double end_cosine = 1.0;
  bool empty() const { return begin > end; }
};

/// A box, a cylinder or an ellipsoid with any pose, solid or hollow. A hollow one is a vessel open at its upper end,
/// with a wall around and below. A hollow ellipsoid keeps only its lower half: a bowl. Lengths in metres, relative to
/// the desk.
struct Primitive {
  enum class Form { box, cylinder, ellipsoid };
  Form form = Form::box;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();      ///< rotation from its own frame, whose third axis is up
  Eigen::Vector3d half = Eigen::Vector3d::Constant(0.05);  ///< half its extents in that frame
  double wall = 0.0;                                       ///< thickness; 0 if solid

  bool hollow() const { return wall > 0.0; }
  double volume() const;  ///< including the hollow, cubic metres
  /// Returns its extent from its centre along a direction of its own frame, the hollow included.
  double reach(const Eigen::Vector3d& own) const;

  /// Returns the parts of a line in the solid, in order: none, one, or two if it passes through the hollow.
  std::array<Chord, 2> inside(const Line& line) const;
  /// Returns the distance at which a line first meets it; infinity if it misses.
  double first_intersection(const Line& line) const;

  /// Returns how far a line through it would have to be moved sideways to miss it, metres, with the hollow counted as
  /// solid. At most 0 if the line misses; `most` if it is more. Exact for boxes, else a close upper bound.
  double aside(const Line& line, double most = kNoHit) const;

  /// Returns the approximate signed distance of a point, metres, negative inside. It is exact at the surface and has
  /// the correct sign everywhere; for solid boxes and cylinders it is exact everywhere. Except for ellipsoids, it never
  /// exceeds the true distance.
  double distance(const Eigen::Vector3d& point) const;
};

}  // namespace palpate
