// SPDX-License-Identifier: MIT
// One Gaussian process and its posterior over the candidates, updated tap by tap.
#pragma once

#include "gp/candidates.hpp"
#include "gp/factor.hpp"

#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <memory>
#include <vector>

namespace palpate {

/// The numbers of a process that are not the kernel's; standard deviations and mean in the unit of the targets.
struct ProcessSettings {
  double signal = 1.0;
  double noise = 0.0;  ///< of one tap, independent from tap to tap, also at one place
  double mean = 0.0;   ///< prior mean, constant
  /// Standard deviation, in signals, of an unknown constant that is added to the mean; 0: the mean is known.
  double mean_ratio = 0.0;
};

/// Regression with a Gaussian process (Rasmussen and Williams 2006, algorithm 2.1) over a fixed set of candidates.
///
/// Inside, targets are standardised, (value - mean) / signal, and the covariance is that of the kernel plus
/// (noise / signal)^2 on the diagonal; every number that leaves is in the unit of the targets again, but for
/// relative_variance().
///
/// Engine `dense`: with L the factor of the covariance of n taps and V = L^-1 K_*, a new tap adds one row to V,
///     v = (k_* - V^T l) / d,   mean += v b,   variance -= v^2,
/// (l, d) its row of L and b its entry of L^-1 targets. That is O(nM) time and memory for M candidates; what earlier
/// taps brought is never computed again, unless the jitter or the hyperparameters change.
///
/// An unknown constant in the mean is integrated out (the same, section 2.7): its posterior needs L^-1 1, which grows
/// like L^-1 targets, and the map V^T L^-1 1.
///
/// A tap that makes the matrix singular in double precision (a duplicate without noise) raises the jitter: a variance
/// added to the whole diagonal and reported by jitter(); it is part of the model from then on. A matrix that is
/// singular even so (a kernel that is not positive definite) is factorised with pivoting, and taps that the others
/// already tell everything about are set aside: they stay recorded but do not enter the posterior.
class Process {
 public:
  /// `candidates` must outlive the process.
  Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& settings, const Points& candidates);

  /// Adds a tap and updates the maps. O(nM).
  void add(const Target& place, double value);

  int size() const { return size_; }

  /// Posterior mean over the candidates, unit of the targets.
  Eigen::VectorXd mean() const;
  /// Posterior variance over the candidates, noise excluded, square of the unit of the targets; in [0, prior].
  Eigen::VectorXd variance() const;
  /// The same relative to the prior variance of each candidate; in [0, 1].
  Eigen::VectorXd relative_variance() const;

  /// log p(targets), natural logarithm, targets in their unit. 0 without taps.
  double log_marginal_likelihood() const;

  /// The variance added to the diagonal by need, square of the unit of the targets.
  double jitter() const { return jitter_ * settings_.signal * settings_.signal; }
  /// How often jitter was raised, and how often pivoting was the last resort.
  int jitter_raised() const { return jitter_raised_; }
  int pivoted() const { return pivoted_; }
  /// How many taps do not enter the posterior.
  int set_aside() const { return size_ - factor_.size(); }
  /// How many candidates' variances rounding has taken out of [0, prior] by now; they read as its ends.
  int variances_clamped() const;
  /// Estimate of the condition number of the covariance of the taps, noise and jitter included.
  double condition() const { return factor_.condition(); }

  const ProcessSettings& settings() const { return settings_; }
  const Kernel& kernel() const { return *kernel_; }

  /// Lets `fitting` choose the hyperparameters of `processes` from their taps, and rebuilds if it changed them,
  /// O(n^2 M). Several processes fitted together share kernel and places, and afterwards their ratio of noise to
  /// signal. Numbers that are not finite and positive are refused: then the old ones stay.
  static FitSummary fit(const std::vector<Process*>& processes, const Fitting& fitting, Random& random);

 private:
  bool append(int tap);
  void rebuild();
  bool refactor(const std::vector<int>& taps);
  void reserve(int taps);
  /// Precision of the unknown constant after the taps: 1 / mean_ratio^2 + 1^T K^-1 1.
  double constant_precision() const;
  Eigen::VectorXd standard_variance() const;
  double prior_of_constant() const { return settings_.mean_ratio * settings_.mean_ratio; }

  std::shared_ptr<Kernel> kernel_;
  ProcessSettings settings_;
  const Points& candidates_;
  Eigen::VectorXd prior_;  ///< kernel variance at each candidate

  int size_ = 0;
  Points points_;            ///< first size_ rows, in the order of the taps
  Eigen::VectorXd targets_;  ///< as given

  Factor factor_;
  Points factored_;            ///< the points of the rows of factor_: those of the taps unless some are set aside
  Eigen::VectorXd reduced_;    ///< L^-1 standardised targets
  Eigen::VectorXd constant_;   ///< L^-1 1; only with an unknown constant
  Eigen::MatrixXd rows_;       ///< M x n: V^T, a row of the factor a column
  Eigen::VectorXd mean_;       ///< standardised, without the unknown constant
  Eigen::VectorXd explained_;  ///< V^T L^-1 1: how much of the constant the taps tell at each candidate
  Eigen::VectorXd variance_;
  Eigen::VectorXd covariance_;  ///< scratch: of the new tap with the earlier ones
  double jitter_ = 0.0;         ///< relative to signal^2
  int jitter_raised_ = 0;
  int pivoted_ = 0;
};

}  // namespace palpate
