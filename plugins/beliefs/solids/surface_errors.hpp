// SPDX-License-Identifier: MIT
// Errors of a closed surface against the true scene, from the points where lines from all sides first meet it, and from
// volumes.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/candidate_lines.hpp"
#include "solids/cloud_distances.hpp"
#include "solids/residual_gp.hpp"
#include "solids/volume.hpp"

#include <palpate/reconstruction_errors.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <optional>

namespace palpate {

/// Returns the points where `lines` first meet the surface of the solids with the residual GP: at most one per cube
/// with this side (metres). Heights are relative to the desk.
Cloud surface_points(const LineBundle& lines, double side, const AssemblySampler& solids,
                     const ResidualGp& residual_gp);

/// Returns the standard deviation of the surface near each of `points`, metres. It combines the variance of the
/// residual GP with the distances of the other particles' surfaces, clipped to 2 cm.
Eigen::VectorXd surface_std(const Cloud& points, const AssemblySampler& solids, const ResidualGp& residual_gp);

/// The true scene, and the lines and cubes for the comparison.
class SurfaceErrors {
 public:
  explicit SurfaceErrors(const SearchBall& region);

  /// Sets the true scene in its current state; null if unknown. The scene must live until the next call.
  void set_truth(const Scene* scene);

  /// Returns the errors of a surface. If `solids` is null, no surface is estimated yet, and the whole true surface is
  /// missing. All errors are absent if the truth is unknown, or if no line meets it.
  Errors compare(const AssemblySampler* solids, const ResidualGp& residual_gp);

 private:
  struct Truth {
    Cloud points;       ///< one per cube of 1 mm
    Cubes::Held cubes;  ///< solid cubes
  };
  const Truth& truth();
  /// Returns the share of points whose distance to the truth is within the 95 % interval.
  std::optional<double> coverage(const Cloud& points, const AssemblySampler& solids, const ResidualGp& residual_gp);

  LineBundle lines_;
  Cubes cubes_;
  const Scene* scene_ = nullptr;
  std::optional<Truth> truth_;
};

}  // namespace palpate
