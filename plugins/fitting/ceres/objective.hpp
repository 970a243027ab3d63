// SPDX-License-Identifier: MIT
// The data of a fit, and its objective as a function of the logarithms of the hyperparameters, with the gradient.
#pragma once

#include "strip_matrix.hpp"

#include <palpate/fitting.hpp>
#include <palpate/types.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpate::fitting {

/// Data and model of a fit over n points and m outputs. The points may be a subset of all points.
///
/// The hyperparameters x have this order: the logarithm of each of the P kernel parameters, of the squared noise ratio,
/// and of the squared signal per output. If `fit_means` is set, the mean per output follows. Targets, signals and means
/// are relative to `centres` and in units of `scales`. All are therefore of order 1, and a fit does not depend on
/// earlier fits.
struct FitModel {
  Points points;            ///< n x 2, metres
  Eigen::MatrixXd targets;  ///< n x m values: (target - centre) / scale
  Eigen::VectorXd centres;  ///< m values: prior mean, or mean of the targets if the prior mean is unknown
  Eigen::VectorXd scales;   ///< m values: largest deviation of a target from the centre
  Kernel& kernel;           ///< kernel whose parameters every evaluation changes
  double mean_ratio = 0.0;
  Eigen::VectorXd means;  ///< m values: (prior mean - centre) / scale
  bool fit_means = false;
  std::vector<std::size_t> used;  ///< m values: indices of these outputs in the problem

  Eigen::Index size() const { return points.rows(); }
  Eigen::Index outputs() const { return targets.cols(); }

  /// Converts a value of the objective for reports: to the sum over all points, for targets in their original unit.
  double total(double value) const;
};

/// Returns the model of a problem. Outputs whose targets are constant up to rounding carry no information and are left
/// out, so m may be 0.
FitModel model_of(const FitProblem& problem, bool fit_means);

/// Returns a model with every second point. If these are fewer than `least`, returns a model with `least` evenly spaced
/// points.
FitModel part_of(const FitModel& all, Eigen::Index least);

/// Returns the present hyperparameters of the problem as x. A noise of 0 becomes -infinity.
Eigen::VectorXd present(const FitProblem& problem, const FitModel& model);

/// Sets the hyperparameters of the problem to `x`.
void take(const Eigen::VectorXd& x, const FitModel& model, FitProblem& problem);

enum class Measure { log_marginal_likelihood, leave_one_out };

/// Prior of one hyperparameter: a normal density of its logarithm, and limits with smooth walls. If a likelihood grows
/// without bound, the walls ensure that there is a maximum.
struct HyperPrior {
  double centre = 0.0;
  double spread = 1.0;
  double least = 0.0;
  double most = 0.0;
};

/// Objective of a fit: the chosen measure per point and output. If requested, the log density of the priors is added.
///
/// Log marginal likelihood: Rasmussen and Williams 2006, equations 2.30 and 5.9. Leave-one-out log predictive density:
/// equations 5.10 to 5.13. Each derivative is the sum over all entries of dF/dK times dK. One inverse is therefore
/// enough for all derivatives.
class Objective {
 public:
  /// `expectations` has one prior per hyperparameter. If `priors` is false, only their limits are used. `model` and
  /// `expectations` must outlive the object.
  Objective(const FitModel& model, Measure measure, const std::vector<HyperPrior>& expectations, bool priors);

  int size() const { return static_cast<int>(expectations_.size()); }
  int evaluations() const { return evaluations_; }

  /// Computes the value at x, and its gradient unless `gradient` is null. Returns false if the value is not finite.
  bool evaluate(const double* x, double* value, double* gradient);

  /// Computes the squared signal of each output that maximises the likelihood, with all other hyperparameters fixed.
  /// Returns the log marginal likelihood at these signals, per point and output, without priors. Returns -infinity if
  /// the matrix cannot be factorised.
  double profiled(const Eigen::VectorXd& kernel_logs, double log_noise, Eigen::VectorXd& log_signals);

 private:
  void set_kernel(const double* logs);
  void fill(bool slopes);
  /// Returns the number of columns of a strip from the first column to the end of its diagonal tile, at most n.
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

  const FitModel& model_;
  Measure measure_;
  const std::vector<HyperPrior>& expectations_;
  bool priors_;
  int evaluations_ = 0;

  Eigen::Index parameters_;          ///< number of kernel parameters
  StripMatrix matrix_;               ///< at first K, then its factor L, then its inverse, then dF/dK
  std::vector<double> reciprocals_;  ///< reciprocals of the diagonal of L
  StripMatrix upper_;                ///< L^-T; computed only with a gradient
  Points places_;                    ///< points, extended to whole strips by copies of the last one
  /// Derivatives of K by the logarithm of each parameter. A strip is stored up to its diagonal tile, with all columns
  /// for the first parameter, then all columns for the next one.
  std::vector<ColumnPack> slopes_;
  Eigen::VectorXd own_;       ///< n values: diagonal of K
  Eigen::MatrixXd standard_;  ///< n x m values: (targets - mean) / signal
  /// L^-1 * standard_ in whole strips. With an unknown mean, the mean is integrated out. After invert(), this is K^-1 *
  /// standard_.
  Eigen::MatrixXd solved_;
  Eigen::VectorXd squares_;  ///< m values: standard^T * K^-1 * standard
  /// Like solved_, but for the vector of ones, 1, divided by sqrt(1 / mean_ratio^2 + 1^T * K^-1 * 1). Computed only
  /// with an unknown mean.
  Eigen::VectorXd ones_;
  double log_determinant_ = 0.0;
  double noise_ = 0.0;  ///< squared noise ratio
};

}  // namespace palpate::fitting
