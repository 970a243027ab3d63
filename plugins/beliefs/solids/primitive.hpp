// SPDX-License-Identifier: MIT
// Simple solids, of which assemblies consist, and their intersections with lines.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <array>
#include <limits>

namespace palpate {

/// kNoHit: distance along a line to a solid that it misses. kHalfTurn: 180 degrees in radians.
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
/// with a wall at its sides and at its bottom. A hollow ellipsoid keeps only its lower half: a bowl. Lengths are in
/// metres, heights relative to the desk.
struct Primitive {
  enum class Form { box, cylinder, ellipsoid };
  Form form = Form::box;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();      ///< rotation from its own frame, whose third axis is up
  Eigen::Vector3d half = Eigen::Vector3d::Constant(0.05);  ///< half its extents in that frame
  double wall = 0.0;                                       ///< thickness; 0 if solid

  bool hollow() const { return wall > 0.0; }
  double volume() const;  ///< including the hollow, cubic metres
  /// Returns the largest extent from the centre along the unit vector `own` in its own frame, metres. The hollow counts
  /// as solid.
  double reach(const Eigen::Vector3d& own) const;

  /// Returns the parts of a line in the solid, in order: none, one, or two if it passes through the hollow.
  std::array<Chord, 2> inside(const Line& line) const;
  /// Returns the distance at which a line first meets the primitive; infinity if the line misses.
  double first_intersection(const Line& line) const;

  /// Returns the sideways shift after which a line through the primitive would miss it, metres. The hollow counts as
  /// solid. The result is at most 0 if the line misses, and never more than `most`. It is exact for boxes, else a close
  /// upper bound.
  double aside(const Line& line, double most = kNoHit) const;

  /// Returns the approximate signed distance of a point, metres, negative inside. It is exact at the surface and has
  /// the correct sign everywhere; for solid boxes and cylinders it is exact everywhere. Except for ellipsoids, it never
  /// exceeds the true distance.
  double distance(const Eigen::Vector3d& point) const;
};

}  // namespace palpate
