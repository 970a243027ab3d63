// SPDX-License-Identifier: MIT
// Which taps lie, and what is believed of a surface if some do.
//
// A tap tells the surface, y_i = f(x_i) + noise, or it lies: then y_i is anything that a height may be before any tap.
// With pi_i the probability that tap i lies before any heights are compared, and b_i the density of a lie, the sets S
// of taps that do have
//     p(S | y) ~ prod_{i in S} pi_i b_i  prod_{i not in S} (1 - pi_i)  p(y without S).
// With A = K^-1, K the covariance of all taps with their noise, a set that is left out needs no factor of its own:
//     A' = A - A_:S (A_SS)^-1 A_S:,   log det K' = log det K + log det A_SS,
// |S|^3 + n |S|^2 a set, and O(n) for all sets that have one tap more. There are 2^n; the likeliest are found by
// looking at the neighbours of the likeliest whose neighbours are not known yet, and it is told how likely the first is
// of which they were not looked at.
//
// Whether a height is odd depends on how far the surface goes up and down and on how exact a tap is, which a config
// does not know: the same sum is made for several signals and noises, and each counts by its evidence. What is flat by
// itself need not be as high as another thing beside it: with each signal goes a broad one, the same for all.
//
// The posterior of the surface is the mixture of those of all sets, signals and noises. With z(x) = (1, k(x), l(x)), k
// and l the unit covariances of x with the taps, l the broad ones, its mean and variance are a linear and a quadratic
// form whose coefficients are means over them,
//     m(x) = z^T a,   v(x) = s2 k(x, x) + z^T B z:
// the maps cost what a single set would.
#pragma once

#include "regular/regular_factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// What is known of n taps before their heights are compared. Heights and deviations in one unit.
struct OutlierProblem {
  Eigen::MatrixXd covariance;        ///< of the taps, n x n, at a signal of 1, without noise
  Eigen::MatrixXd broad_covariance;  ///< likewise, of the broad signal; empty where there is none
  Eigen::VectorXd heights;           ///< y, less the prior mean
  Eigen::VectorXd prior;             ///< pi, in [0, 1]
  std::vector<double> signals;       ///< deviations that the surface may have, each as probable as the others
  std::vector<double> noises;        ///< the same of the noise of a tap, all above 0
  Eigen::VectorXd extra_variance;    ///< n: variance that a tap's noise has beside that; empty for none
  double broad_signal = 0.0;         ///< deviation of the broad signal
  double mean_deviation = 0.0;       ///< deviation of a constant that is added to all of f; 0: there is none
  double outlier_deviation = 1.0;    ///< deviation of a lie: it is normal about the prior mean
};

/// How far the sum over the sets goes.
struct OutlierSearchLimits {
  int expansions = 32;       ///< at most so many sets have their neighbours looked at
  double min_summed = 1e-4;  ///< a set less likely than this, beside the likeliest, is not summed
  double min_expanded =
      1e-8;  ///< nor is one looked at that is less likely than this: likely ones may lie behind others
};

struct OutlierPosterior {
  Eigen::VectorXd probability;  ///< n: the probability that a tap lies
  Eigen::VectorXd a;            ///< 1 + 2 n: the constant, then k, then l
  Eigen::MatrixXd b;            ///< as many square, symmetric
  double s2 = 0.0;              ///< mean of the square of the signals, that of the broad one included
  int summed_sets = 0;          ///< how many were summed
  double next_weight = 0.0;  ///< how likely, beside the likeliest, is the first set whose neighbours were not looked at
  /// log p(y), natural logarithm, of the mean over signals and noises, but for a number that hangs on n alone.
  double log_evidence = 0.0;
  FactorReport report;  ///< the largest jitter, the most rows set aside and all counts of the factorisations
};

/// Sums over the sets. A noise that is below what the forms take (kInverseNoise) is raised to that, which the report
/// counts as jitter. Rows that no jitter makes independent of the others are set aside, for each signal and noise by
/// itself: there they keep their suspicion and tell nothing. All numbers are finite where heights and covariances are,
/// and far from overflow. Never throws.
OutlierPosterior infer_outliers(const OutlierProblem& problem, const OutlierSearchLimits& limits = {});

}  // namespace palpate
