// SPDX-License-Identifier: MIT
// The words of the domain that every plugin shares: points, taps and what a tap brings back.
// All quantities are SI: metres, seconds, newtons, radians.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace palpate {

/// n points on the desk, one a row: x, y in metres, in the frame of the area (origin at its lower left corner).
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Views that cross the plugin boundary: the caller owns and sizes them, the callee never resizes.
using PointsView = Eigen::Ref<const Points>;
using VectorView = Eigen::Ref<const Eigen::VectorXd>;
using VectorOut = Eigen::Ref<Eigen::VectorXd>;
using MatrixOut = Eigen::Ref<Eigen::MatrixXd>;

/// Where the next tap goes, in metres within the area.
struct Target {
  double x = 0.0;
  double y = 0.0;
};

/// A straight line without ends: the points origin + x * direction for every real x.
struct Line {
  Eigen::Vector3d origin;     ///< metres
  Eigen::Vector3d direction;  ///< of unit length
};

/// How far along a line that goes down it is at a height; infinity for one that is level or goes up.
inline double distance_down_to(double height, const Line& line) {
  const double down = line.direction.z();
  return down < 0.0 ? (height - line.origin.z()) / down : std::numeric_limits<double>::infinity();
}

/// A contact as the models see it.
struct Touch {
  Target place;
  double height = 0.0;  ///< above the desk, metres
  bool on = false;      ///< on an object, by the scene's rule (`min_object_height`)
};

/// Hypotheses of the footprint, drawn as often as they are probable, and which candidates are on an object in each: so
/// that candidates are together on one object, which M probabilities do not show.
struct HypothesisSample {
  int count = 0;  ///< a multiple of 64; 0 without hypotheses
  /// count / 64 x M: bit k % 64 of row k / 64 says whether hypothesis k has an object at a candidate.
  Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic> holds;
  /// M values, square metres: expected area of objects that a tap discovers, beside all that was touched so far.
  Eigen::VectorXd expected_discovery_area;
};

}  // namespace palpate
