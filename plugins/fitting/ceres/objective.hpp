// SPDX-License-Identifier: MIT
// Data of a fit, and its objective as a function of the logarithms of the hyperparameters, with gradient.
#pragma once

#include "strip_matrix.hpp"

#include <palpate/fitting.hpp>
#include <palpate/types.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpate::fitting {

/// Data and model of a fit, for all or a part of its points: n points, m outputs.
///
/// The hyperparameters are, in the order of the search: log of each of the P kernel parameters, log of the squared
/// noise ratio, log of the squared signal per output, and, if `fit_means`, the mean per output. Targets, signals and
/// means are relative to `centres`, in units of `scales`. So all are of order 1, and a fit does not depend on the one
/// before.
struct Model {
  Points points;            ///< n x 2, metres
  Eigen::MatrixXd targets;  ///< n x m: (target - centre) / scale
  Eigen::VectorXd centres;  ///< m: prior mean, or mean of the targets if the mean is unknown
  Eigen::VectorXd scales;   ///< m: largest deviation of a target from the centre
  Kernel& kernel;           ///< every evaluation changes its parameters
  double mean_ratio = 0.0;
  Eigen::VectorXd means;  ///< m: (prior mean - centre) / scale
  bool fit_means = false;
  std::vector<std::size_t> used;  ///< m: indices of these outputs in the problem

  Eigen::Index size() const { return points.rows(); }
  Eigen::Index outputs() const { return targets.cols(); }

  /// Converts a value of the objective to the sum over all points, for targets in their original unit; for reports.
  double total(double value) const;
};

/// Returns the model of a problem. Outputs with constant targets, up to rounding, carry no information and are omitted;
/// m may be 0.
Model model_of(const FitProblem& problem, bool fit_means);

/// Returns a model with every second point, or evenly chosen ones if these are fewer than `least`.
Model part_of(const Model& all, Eigen::Index least);

/// Returns the present hyperparameters of the problem; -infinity for a noise of 0.
Eigen::VectorXd present(const FitProblem& problem, const Model& model);

/// Copies the hyperparameters `x` to the problem.
void take(const Eigen::VectorXd& x, const Model& model, FitProblem& problem);

enum class Measure { log_marginal_likelihood, leave_one_out };

/// Prior of one hyperparameter on the scale of the search: a normal density, and limits with smooth walls. The walls
/// ensure a maximum if a likelihood grows without bound.
struct HyperPrior {
  double centre = 0.0;
  double spread = 1.0;
  double least = 0.0;
  double most = 0.0;
};

/// The measure per point and output, plus the log density of the priors if requested.
///
/// Log marginal likelihood: Rasmussen and Williams 2006, equations 2.30 and 5.9. Leave-one-out log predictive density:
/// equations 5.10 to 5.13. Each derivative is the sum over all entries of dF/dK times dK, so one inverse serves all.
class Objective {
 public:
  /// `expectations`: one per hyperparameter. With `priors` false, only their limits are used. The first and third
  /// argument must outlive the object.
  Objective(const Model& model, Measure measure, const std::vector<HyperPrior>& expectations, bool priors);

  int size() const { return static_cast<int>(expectations_.size()); }
  int evaluations() const { return evaluations_; }

  /// Computes the value at x, and its gradient unless `gradient` is null. Returns false if the value is not finite.
  bool evaluate(const double* x, double* value, double* gradient);

  /// Computes the squared signal of each output that maximises the likelihood, for given other hyperparameters. Returns
  /// the log marginal likelihood there, per point and output, without priors; -infinity if the matrix cannot be
  /// factorised.
  double profiled(const Eigen::VectorXd& kernel_logs, double log_noise, Eigen::VectorXd& log_signals);

 private:
  void set_kernel(const double* logs);
  void fill(bool slopes);
  /// Returns the number of columns of a strip up to the end of its diagonal tile, at most n.
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
  const std::vector<HyperPrior>& expectations_;
  bool priors_;
  int evaluations_ = 0;

  Eigen::Index parameters_;          ///< number of kernel parameters
  StripMatrix matrix_;               ///< in turn K, its factor L, its inverse, and dF/dK
  std::vector<double> reciprocals_;  ///< reciprocals of the diagonal of L
  StripMatrix upper_;                ///< L^-T; only with a gradient
  Points places_;                    ///< points padded to whole strips by repeating the last one
  /// Derivatives of K by the log of each parameter, per strip up to its diagonal tile: all columns for the first
  /// parameter, then those for the next.
  std::vector<Line> slopes_;
  Eigen::VectorXd own_;       ///< n: diagonal of K
  Eigen::MatrixXd standard_;  ///< n x m: (targets - mean) / signal
  /// L^-1 standard_ in whole strips, with an unknown constant integrated out; K^-1 standard_ after invert().
  Eigen::MatrixXd solved_;
  Eigen::VectorXd squares_;  ///< m: standard^T K^-1 standard
  Eigen::VectorXd ones_;     ///< as solved_, for 1 / sqrt(1 / mean_ratio^2 + 1^T K^-1 1); only with an unknown constant
  double log_determinant_ = 0.0;
  double noise_ = 0.0;  ///< squared noise ratio
};

}  // namespace palpate::fitting
