// SPDX-License-Identifier: MIT
// Surfaces as clouds of points, and how far two are apart.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace palpate {

/// The lines by which a surface is looked at, from all sides from which a tool may come: those of every direction that
/// comes down, level, or up by no more than 30 degrees, side by side, through a ball.
struct Bundle {
  Bundle(const Eigen::Vector3d& centre, double radius, int directions, double pitch);

  std::vector<Line> lines;  ///< each begins on the ball, above the desk
};

using Cloud = std::vector<Eigen::Vector3d>;

/// At most one of the points in each cube of this side.
Cloud thinned(const Cloud& points, double side);

/// The distance from each point of `from` to the nearest of `to`, metres; infinity where none is within 10 cm, which is
/// the most that is told apart.
std::vector<double> nearest_distances(const Cloud& from, const Cloud& to);

/// Of two surfaces, of which some points say how far they are from the other: at most one in a cube of 3 mm.
struct CloudErrors {
  double mean = 0.0;          ///< mean nearest-neighbour distance over the points of both, metres
  double of_truth = 0.0;      ///< from the points of the truth alone: what is missing
  double of_belief = 0.0;     ///< from those of the reconstruction: what is too much
  double rms = 0.0;           ///< root mean square, over the points of both
  double rms_of_truth = 0.0;  ///< over those of the truth
  double f_score = 0.0;       ///< at 5 mm: harmonic mean of the shares of either within 5 mm of the other
};
/// How far apart the points of the clouds are limits what can be told: of the same surface, seen twice by points 1 mm
/// apart, the mean is about 0.4 mm.
CloudErrors compare_clouds(const Cloud& belief, const Cloud& truth);

}  // namespace palpate
