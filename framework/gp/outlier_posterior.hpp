// SPDX-License-Identifier: MIT
// Inference of the taps that are outliers, and of the surface without them.
//
// The height of an inlier is y_i = f(x_i) + noise. The height of an outlier has the prior of any height, with density
// b_i. With the prior probability pi_i of an outlier, a set S of outliers has
//     p(S | y) ~ prod_{i in S} pi_i b_i  prod_{i not in S} (1 - pi_i)  p(y without S).
// Let A = K^-1, with K the covariance of all taps with their noise. The taps outside of S need no factorisation:
//     A' = A - A_:S (A_SS)^-1 A_S:,   log det K' = log det K + log det A_SS,
// at |S|^3 + n |S|^2 for the set, and O(n) for all sets that have one more tap. A search (OutlierSearch) finds the most
// probable of the 2^n sets.
//
// Whether a height is unusual depends on the variation of the surface and on the noise of a tap. A config gives only
// rough values, so the sum is over several signals and noises, weighted by their evidence. Each signal is combined with
// a broad signal of longer range, because neighbouring flat surfaces may have different heights.
//
// The posterior of the surface is the mixture over all sets, signals and noises. With z(x) = (1, k(x), l(x)), where k
// and l are the covariances of x with the taps at unit signal and l belongs to the broad signal, mean and variance are
//     m(x) = z^T a,   v(x) = s2 k(x, x) + z^T B z,
// whose coefficients are averages over the mixture. So the maps cost no more than the maps of a single set.
#pragma once

#include "regular/regular_factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// Prior and heights of n taps. Heights and standard deviations have one unit.
struct OutlierProblem {
  Eigen::MatrixXd covariance;        ///< covariance of the taps, n x n, at a signal of 1, without noise
  Eigen::MatrixXd broad_covariance;  ///< covariance of the broad signal; empty for none
  Eigen::VectorXd heights;           ///< y, minus the prior mean
  Eigen::VectorXd prior;             ///< pi, in [0, 1]
  std::vector<double> signals;       ///< standard deviations of the surface, equally probable
  std::vector<double> noises;        ///< standard deviations of a tap's noise, equally probable, above 0
  Eigen::VectorXd extra_variance;    ///< n: variance of each tap in addition to the noise; empty for none
  double broad_signal = 0.0;         ///< standard deviation of the broad signal
  double mean_deviation = 0.0;       ///< standard deviation of a constant that is added to f; 0 for none
  double outlier_deviation = 1.0;    ///< standard deviation of an outlier, which is normal about the prior mean
};

/// Limits of the search, for each signal and noise.
struct OutlierSearchLimits {
  int expansions = 32;         ///< largest number of sets that are extended by one more tap
  double min_summed = 1e-4;    ///< smallest weight, relative to the largest, of a set that is summed
  double min_expanded = 1e-8;  ///< smallest relative weight of an extended set, which may lead to a probable one
};

struct OutlierPosterior {
  Eigen::VectorXd probability;  ///< n: probability of an outlier
  Eigen::VectorXd a;            ///< 1 + 2 n: the constant, then k, then l
  Eigen::MatrixXd b;            ///< (1 + 2 n) x (1 + 2 n), symmetric
  double s2 = 0.0;              ///< mean of the squared signals, the broad signal included
  int summed_sets = 0;
  double next_weight = 0.0;  ///< weight, relative to the largest, of the first set that was not extended
  /// log p(y), natural logarithm, averaged over signals and noises, up to a number that depends on n alone.
  double log_evidence = 0.0;
  FactorReport report;  ///< largest jitter, most redundant rows, and all counts of the factorisations
};

/// Computes the posterior by a sum over sets. A noise below kInverseNoise is raised to it, which the report counts as
/// jitter. Rows that no jitter makes independent are left out per signal and noise; there they keep their prior and do
/// not inform the surface. All numbers are finite if heights and covariances are finite and far from overflow. Never
/// throws.
OutlierPosterior infer_outliers(const OutlierProblem& problem, const OutlierSearchLimits& limits = {});

}  // namespace palpate
