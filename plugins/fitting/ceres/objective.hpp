// SPDX-License-Identifier: MIT
// The data of a fit, and what it maximises as a function of the logarithms of the hyperparameters, with its gradient.
#pragma once

#include "symmetric.hpp"

#include <palpate/fitting.hpp>
#include <palpate/types.hpp>

#include <algorithm>
#include <cstddef>
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

enum class Measure { log_marginal_likelihood, leave_one_out };

/// Where one hyperparameter is expected, on the scale of the search: a normal density, and limits beyond which a
/// smooth wall rises, so that a likelihood which grows for ever still has a maximum.
struct Expectation {
  double centre = 0.0;
  double spread = 1.0;
  double least = 0.0;
  double most = 0.0;
};

/// The measure per point and output, plus the log density of the expectations if they are given.
///
/// Log marginal likelihood: Rasmussen and Williams 2006, equations 2.30 and 5.9. Leave-one-out log predictive density:
/// equations 5.10 to 5.13. Every derivative is the sum over the entries of dF/dK times dK: one inverse serves all.
class Objective {
 public:
  /// `expectations`: one for each hyperparameter, or none: then walls are all there is. All three must outlive it.
  Objective(const Model& model, Measure measure, const std::vector<Expectation>& expectations, bool priors);

  int size() const { return static_cast<int>(expectations_.size()); }
  int evaluations() const { return evaluations_; }

  /// Value at x, and its gradient unless that is null. False where the value is no finite number.
  bool evaluate(const double* x, double* value, double* gradient);

  /// The squared signal of each output at which the likelihood is largest, everything else given; and the log marginal
  /// likelihood there, per point and output, without priors. Not finite when the matrix cannot be factorised.
  double profiled(const Eigen::VectorXd& kernel_logs, double log_noise, Eigen::VectorXd& log_signals);

 private:
  void set_kernel(const double* logs);
  void fill(bool slopes);
  /// Columns of a strip up to the end of its tile of the diagonal, or of all.
  Eigen::Index columns(Eigen::Index strip) const { return std::min(model_.size(), 8 * (strip + 1)); }
  Eigen::Index slopes_of(Eigen::Index strip) const { return strip * parameters_ * 8 * matrix_.strips(); }
  bool decompose(double noise);
  void solve(const Eigen::MatrixXd& targets);
  void invert();
  double likelihood(const double* log_signals) const;
  void likelihood_gradient(double* gradient);
  double leave_one_out(double* gradient);
  void contract(double* gradient) const;
  double expectations(const double* x, double* gradient) const;

  const Model& model_;
  Measure measure_;
  const std::vector<Expectation>& expectations_;
  bool priors_;
  int evaluations_ = 0;

  Eigen::Index parameters_;          ///< of the kernel
  Strips matrix_;                    ///< K, its factor L, its inverse, and dF/dK, one after the other
  std::vector<double> reciprocals_;  ///< of the diagonal of L
  Strips upper_;                     ///< L^-T; only with a gradient
  Points places_;                    ///< rows of whole strips: the last point again and again
  std::vector<Line> slopes_;  ///< dK / d log parameter, of each strip what is not right of its tile of the diagonal:
                              ///< all columns by the first parameter, then those by the next
  Eigen::VectorXd own_;       ///< n: the diagonal of K
  Eigen::MatrixXd standard_;  ///< n x m: (targets - mean) / signal
  Eigen::MatrixXd solved_;    ///< rows of whole strips x m: L^-1 standard, the unknown constant integrated out;
                              ///< with a gradient K^-1 of it
  Eigen::VectorXd squares_;   ///< m: standard^T K^-1 standard
  Eigen::VectorXd ones_;      ///< the same of 1 / sqrt(1 / mean_ratio^2 + 1^T K^-1 1); only with an unknown constant
  double log_determinant_ = 0.0;
  double noise_ = 0.0;  ///< squared noise ratio
};

}  // namespace palpate::fitting
