// SPDX-License-Identifier: MIT
// Errors of a closed surface against the true scene: by points where lines from all sides first meet it, and by volume.
#pragma once

#include "solids/cloud.hpp"
#include "solids/line_sampler.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"
#include "solids/volume.hpp"

#include <palpate/errors.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <optional>

namespace palpate {

/// The surface that solids and residual GP describe, where `lines` first meet it: at most one point in a cube of `side`
/// metres, relative to the desk.
Cloud surface_points(const Bundle& lines, double side, const Solids& solids, const ResidualGp& residual_gp);

/// Returns the standard deviation of the surface near such points, metres: what the residual GP leaves open, and the
/// distances of the other particles' surfaces there, none more than 2 cm.
Eigen::VectorXd surface_std(const Cloud& points, const Solids& solids, const ResidualGp& residual_gp);

/// What is truly there, and the lines and cubes by which it is compared.
class SurfaceErrors {
 public:
  explicit SurfaceErrors(const Region& region);

  /// Sets the true scene as it stands now, null if it is not known. It outlives the next call.
  void set_truth(const Scene* scene);

  /// Returns the errors of a surface; null: none is believed, and all of the true surface is missing. Without a known
  /// truth, or if nothing of it can be met, all are absent.
  Errors compare(const Solids* solids, const ResidualGp& residual_gp);

 private:
  struct Truth {
    Cloud points;       ///< one in a cube of 1 mm
    Cubes::Held cubes;  ///< that are solid
  };
  const Truth& truth();
  /// Share of points whose distance to the truth is within the 95 % interval.
  std::optional<double> coverage(const Cloud& points, const Solids& solids, const ResidualGp& residual_gp);

  Bundle lines_;
  Cubes cubes_;
  const Scene* scene_ = nullptr;
  std::optional<Truth> truth_;
};

}  // namespace palpate
