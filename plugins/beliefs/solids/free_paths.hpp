// SPDX-License-Identifier: MIT
// The points of free paths that hold the surface back (active constraints), and the data of the residual GP that
// include these points (residual_gp.hpp).
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/residual_kernel.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// Metres. A contact that is farther from the solids belongs to an object that the solids lack.
inline constexpr double kMaxResidual = 0.012;

/// Data of the residual GP. The rows of free paths come last.
struct ResidualData {
  std::vector<ResidualKernel::ResidualDatum> rows;
  ResidualKernel::DatumTable table;
  /// Cholesky factor of the covariance, noise included, of all data except the points of free paths.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> lower;
  Eigen::VectorXd weights;

  /// Returns an upper bound of the absolute mean of g at any place, metres.
  double reach(const ResidualKernel& kernel) const;
  /// Returns the mean of g at these places.
  Eigen::VectorXd means(const ResidualKernel& kernel, const ResidualKernel::Places& places) const;
};

/// The free paths of a fit.
struct FreePaths {
  std::vector<ResidualKernel::ResidualDatum> points;  ///< points that were inside the surface in any round of the fit
  /// Number of paths that are still inside the surface by more than their noise, at points other than those that hold
  /// it back. If the number is above 0, the fit ended at its largest number of rounds.
  int violated = 0;
  int redundant = 0;  ///< number of points that are left out, because the matrix would be singular with them
};

/// Adds those points of free paths to `known` that hold the surface back in the optimum. `known` must contain the
/// contacts. `noise`: standard deviation of a contact, metres.
FreePaths hold_free_paths(const ResidualKernel& kernel, const Assembly& solids,
                          const std::vector<SurfaceTouch>& touches, double noise, ResidualData& known);

}  // namespace palpate
