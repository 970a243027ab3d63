// SPDX-License-Identifier: MIT
// The points of free paths that hold the surface back, and the data of the residual GP that they complete
// (residual_gp.hpp).
#pragma once

#include "solids/residual_kernel.hpp"
#include "solids/solids.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// Metres; what is farther from the solids belongs to an object that they lack.
inline constexpr double kMaxResidual = 0.012;

/// Data that the residual GP has taken in, those of free paths last.
struct ResidualData {
  std::vector<ResidualKernel::Row> rows;
  ResidualKernel::Table table;
  /// The Cholesky factor of the covariance of all data but those of free paths, noise included.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> lower;
  Eigen::VectorXd weights;

  /// Returns the largest absolute mean of g anywhere, metres; an upper bound.
  double reach(const ResidualKernel& kernel) const;
  /// Returns the mean of g at these places.
  Eigen::VectorXd means(const ResidualKernel& kernel, const ResidualKernel::Places& places) const;
};

/// The free paths of a fit.
struct FreePaths {
  std::vector<ResidualKernel::Row> points;  ///< points that were inside the surface at some time
  /// Number of paths that the surface is left in, by more than noise and elsewhere than at points that hold, because
  /// the fit ended before.
  int violated = 0;
  int redundant = 0;  ///< points that are set aside, because the matrix would be singular with them
};

/// Adds to `known`, which has the contacts, the points of free paths that hold, in the optimum. `noise`: of a contact,
/// metres.
FreePaths hold_free_paths(const ResidualKernel& kernel, const Assembly& solids,
                          const std::vector<SurfaceTouch>& touches, double noise, ResidualData& known);

}  // namespace palpate
