// SPDX-License-Identifier: MIT
// The data of a fit and the place of its hyperparameters on the scale of the search.
#pragma once

#include <palpate/fitting.hpp>
#include <palpate/types.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::fitting {

/// The data and the model of a fit, or those of a part of its points: n points, m outputs.
///
/// Hyperparameters in the order of the search: log of each kernel parameter (P), log of the squared noise ratio, then
/// for each output log of the squared signal, then for each output its mean if that is fitted too. Targets, signals and
/// means are in units of `scales` from `centres`, so that all are of order 1 and no fit depends on the one before.
struct Model {
  Points points;            ///< n x 2, metres
  Eigen::MatrixXd targets;  ///< n x m: (target - centre) / scale
  Eigen::VectorXd centres;  ///< m: the prior mean, or the mean of the targets where the model's own is open
  Eigen::VectorXd scales;   ///< m: largest deviation of a target from the centre
  Kernel& kernel;           ///< changed by every evaluation
  double mean_ratio = 0.0;
  Eigen::VectorXd means;  ///< m: (prior mean - centre) / scale
  bool fit_means = false;
  std::vector<std::size_t> used;  ///< m: which outputs of the problem these are

  Eigen::Index size() const { return points.rows(); }
  Eigen::Index outputs() const { return targets.cols(); }

  /// A value of the objective for all points together, targets in their own unit: what is reported.
  double total(double value) const;
};

/// The model of a problem. Outputs whose targets are all alike, up to rounding, tell nothing and are left out; m may
/// be 0.
Model model_of(const FitProblem& problem, bool fit_means);

/// Half of the points, but not less than `least`, evenly over their order.
Model part_of(const Model& all, Eigen::Index least);

/// The present values of the problem; -infinity for a noise of 0.
Eigen::VectorXd present(const FitProblem& problem, const Model& model);

/// Gives the problem the values at `x`.
void take(const Eigen::VectorXd& x, const Model& model, FitProblem& problem);

}  // namespace palpate::fitting
