// SPDX-License-Identifier: MIT
// Infers which taps are outliers, and the surface without these outliers.
//
// The height of an inlier is y_i = f(x_i) + noise, where f is a GP. The height of an outlier does not depend on f; it
// is normally distributed about the prior mean, with the density b_i at y_i. Let pi_i be the prior probability that tap
// i is an outlier. Then the probability of a set S of outliers is proportional to
//     p(S | y) ~ prod_{i in S} pi_i b_i  prod_{i not in S} (1 - pi_i)  p(y without S).
// Let K be the covariance of all taps with their noise, and A = K^-1. K' is the covariance of the taps outside of S,
// and A' its inverse. A' and det K' follow from A without a factorisation of K':
//     A' = A - A_:S (A_SS)^-1 A_S:,   log det K' = log det K + log det A_SS.
// The cost is |S|^3 + n |S|^2 for one set S. The weights of all sets that add one tap to S then cost O(n) in total. A
// search (OutlierSearch) finds the most probable of the 2^n sets.
//
// Whether a height is unusual depends on the variation of the surface and on the noise of a tap. A config gives only
// rough values of signal and noise, so the posterior is a sum over several signals and noises, weighted by their
// evidence. f is the sum of two GPs. The second GP, the broad signal, has a longer length scale, because neighbouring
// flat surfaces may have different heights.
//
// The posterior of the surface is the mixture over all sets, signals and noises. Let k(x) be the covariances of x with
// the taps at a signal of 1, l(x) the same for the broad signal, and z(x) = (1, k(x), l(x)). Then mean and variance are
//     m(x) = z^T a,   v(x) = s2 k(x, x) + z^T B z.
// The coefficients a, B and s2 are averages over the mixture. So the maps cost no more than the maps of a single set.
#pragma once

#include "regular/regular_factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// Prior and heights of n taps. All heights and standard deviations have the same unit.
struct OutlierProblem {
  Eigen::MatrixXd covariance;        ///< kernel covariance of the taps, n x n, at a signal of 1, without noise
  Eigen::MatrixXd broad_covariance;  ///< the same for the broad signal (see above); empty for none
  Eigen::VectorXd heights;           ///< y, minus the prior mean
  Eigen::VectorXd prior;             ///< pi, in [0, 1]
  std::vector<double> signals;       ///< possible standard deviations of the surface, equally probable
  std::vector<double> noises;        ///< possible standard deviations of a tap's noise, equally probable, above 0
  Eigen::VectorXd extra_variance;    ///< n values: variance of each tap in addition to the noise; empty for none
  double broad_signal = 0.0;         ///< standard deviation of the broad signal
  double mean_deviation = 0.0;       ///< standard deviation of a constant that is added to f; 0 for none
  double outlier_deviation = 1.0;    ///< standard deviation of an outlier's height, normal about the prior mean
};

/// Limits of the search, for each signal and noise.
struct OutlierSearchLimits {
  int expansions = 32;       ///< largest number of sets that are extended (by one more tap)
  double min_summed = 1e-4;  ///< smallest weight of a set that is part of the sum, relative to the largest weight
  /// smallest weight of a set that is extended, relative to the largest weight; it is below min_summed, because an
  /// extension may be more probable
  double min_expanded = 1e-8;
};

struct OutlierPosterior {
  Eigen::VectorXd probability;  ///< n values: probability that the tap is an outlier
  Eigen::VectorXd a;            ///< 1 + 2 n coefficients of z (see above): the constant, k, l
  Eigen::MatrixXd b;            ///< (1 + 2 n) x (1 + 2 n), symmetric
  double s2 = 0.0;              ///< average of signal^2 + (broad signal)^2 over the mixture
  int summed_sets = 0;
  double next_weight = 0.0;  ///< weight of the most probable set that was not extended, relative to the largest weight
  /// Natural logarithm of p(y), averaged over signals and noises, up to a constant that depends only on n.
  double log_evidence = 0.0;
  FactorReport report;  ///< jitter and redundant rows: maximum over all factorisations; other counts: sums
};

/// Computes the posterior by a sum over sets. A noise variance below the bound that kInverseNoise defines is raised to
/// this bound, and the report counts the increase as jitter. If rows of the covariance matrix remain linearly dependent
/// even with the largest jitter, their taps are left out for this signal and noise. Such taps keep their prior
/// probability and do not influence the surface. All numbers are finite if heights and covariances are finite and far
/// from overflow. Never throws.
OutlierPosterior infer_outliers(const OutlierProblem& problem, const OutlierSearchLimits& limits = {});

}  // namespace palpate
