// SPDX-License-Identifier: MIT
// Types that every plugin shares: points, lines, contacts, hypotheses.
// All quantities are SI: metres, seconds, newtons, radians.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace palpate {

/// n points on the desk, one per row: x, y in metres, in the frame of the area (origin at its lower left corner).
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Views that cross the plugin boundary. The caller owns and sizes them; the callee never resizes them.
using PointsView = Eigen::Ref<const Points>;
using VectorView = Eigen::Ref<const Eigen::VectorXd>;
using VectorOut = Eigen::Ref<Eigen::VectorXd>;
using MatrixOut = Eigen::Ref<Eigen::MatrixXd>;

/// Position of a tap in the area, metres.
struct Target {
  double x = 0.0;
  double y = 0.0;
};

/// A straight line without ends: the points origin + x * direction for every real x.
struct Line {
  Eigen::Vector3d origin;     ///< metres
  Eigen::Vector3d direction;  ///< unit vector
};

/// Returns the distance along a descending line to a height, metres; infinity for a line that is level or goes up.
inline double distance_down_to(double height, const Line& line) {
  const double down = line.direction.z();
  return down < 0.0 ? (height - line.origin.z()) / down : std::numeric_limits<double>::infinity();
}

/// A contact in the form that the models use.
struct Touch {
  Target place;
  double height = 0.0;  ///< above the desk, metres
  bool on = false;      ///< on an object, by the scene's rule (`min_object_height`)
};

/// Hypotheses of the footprint, sampled from the posterior. Each hypothesis is the set of the candidates that are on an
/// object. Hypotheses show which candidates are on an object together, which M separate probabilities do not show.
struct HypothesisSample {
  int count = 0;  ///< a multiple of 64; 0 without hypotheses
  /// Matrix of count / 64 rows and M columns: bit k % 64 of row k / 64 is set if hypothesis k has an object at the
  /// candidate.
  Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic> holds;
  /// M values, square metres: expected area of the undiscovered objects that a tap at the candidate would find.
  Eigen::VectorXd expected_discovery_area;
};

}  // namespace palpate
