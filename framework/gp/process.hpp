// SPDX-License-Identifier: MIT
// One Gaussian process and its posterior over the candidates, updated tap by tap.
#pragma once

#include "gp/candidates.hpp"
#include "gp/factor.hpp"

#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <memory>

namespace palpate {

/// The numbers of a process that are not the kernel's; standard deviations and mean in the unit of the targets.
struct ProcessSettings {
  double signal = 1.0;
  double noise = 0.0;  ///< of one tap, independent from tap to tap, also at one place
  double mean = 0.0;   ///< prior mean, constant
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
/// A tap that makes the matrix singular in double precision (a duplicate without noise) raises the jitter: a variance
/// added to the whole diagonal and reported by jitter(); it is part of the model from then on.
class Process {
 public:
  /// `candidates` must outlive the process.
  Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& settings, const Points& candidates);

  /// Adds a tap and updates the maps. O(nM).
  void add(const Target& place, double value);

  /// Lets `fitting` choose the hyperparameters from the taps so far, and rebuilds if it changed them: O(n^2 M).
  FitSummary fit(const Fitting& fitting, Random& random);

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
  /// How often jitter was raised.
  int jitter_raised() const { return jitter_raised_; }
  /// How many candidates' variances rounding had taken below 0 when a map was last read; they read as 0.
  int variances_clamped() const;
  double condition() const { return factor_.condition(); }

  const ProcessSettings& settings() const { return settings_; }
  const Kernel& kernel() const { return *kernel_; }

 private:
  bool append(int index);
  void rebuild();
  void reserve(int taps);

  std::shared_ptr<Kernel> kernel_;
  ProcessSettings settings_;
  const Points& candidates_;
  Eigen::VectorXd prior_;  ///< kernel variance at each candidate

  int size_ = 0;
  Points points_;            ///< first size_ rows
  Eigen::VectorXd targets_;  ///< as given

  Factor factor_;
  Eigen::VectorXd reduced_;  ///< L^-1 standardised targets
  Eigen::MatrixXd rows_;     ///< M x n: V^T, a tap a column
  Eigen::VectorXd mean_;     ///< standardised
  Eigen::VectorXd variance_;
  Eigen::VectorXd covariance_;  ///< scratch: of the new tap with the earlier ones
  double jitter_ = 0.0;         ///< relative to signal^2
  int jitter_raised_ = 0;
};

}  // namespace palpate
