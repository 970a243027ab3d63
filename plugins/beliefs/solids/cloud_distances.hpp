// SPDX-License-Identifier: MIT
// Point clouds of surfaces, and the distances between two of them.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// Bundles of parallel lines through a ball. Their directions are spread over all directions in which a tool may move:
/// down, level, or up by at most 30 degrees. The errors of a surface are measured where these lines first meet it.
struct LineBundle {
  LineBundle(const Eigen::Vector3d& centre, double radius, int directions, double pitch);

  std::vector<Line> lines;  ///< each begins on the ball, above the desk
};

using Cloud = std::vector<Eigen::Vector3d>;

/// Returns the first point of `points` in each cube of a grid with this side (metres).
Cloud thinned(const Cloud& points, double side);

/// Returns the distance from each point of `from` to the nearest point of `to`, metres; infinity if that is more than
/// 10 cm.
std::vector<double> nearest_distances(const Cloud& from, const Cloud& to);

/// Errors between two surfaces, from the nearest-neighbour distances of their points, thinned to one per cube of 3 mm.
struct CloudErrors {
  double mean = 0.0;          ///< mean nearest-neighbour distance over the points of both clouds, metres
  double of_truth = 0.0;      ///< mean over the points of the truth, metres; shows parts that the belief lacks
  double of_belief = 0.0;     ///< mean over the points of the belief, metres; shows parts that the truth lacks
  double rms = 0.0;           ///< root mean square distance over the points of both clouds, metres
  double rms_of_truth = 0.0;  ///< root mean square distance over the points of the truth, metres
  double f_score = 0.0;       ///< at 5 mm: harmonic mean of the shares of points within 5 mm of the other cloud
};
/// Returns the errors of `belief` against `truth`. The spacing of the points limits the resolution: two clouds of the
/// same surface with points 1 mm apart have a mean of about 0.4 mm.
CloudErrors compare_clouds(const Cloud& belief, const Cloud& truth);

}  // namespace palpate
