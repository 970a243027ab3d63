// SPDX-License-Identifier: MIT
// Means of clustered samples with Student's t intervals, their standard deviation, and the power of the paired t test.
#pragma once

#include "record/quantiles.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// An interval with its lower and upper end.
struct MeanInterval {
  double low = 0.0;
  double high = 0.0;
};

/// Values of a sample by cluster. Values in one cluster may depend on each other; different clusters are independent
/// (jobs with the same seed form a cluster). No cluster is empty.
using Clusters = std::vector<std::vector<double>>;

/// Returns the means of the clusters in their order. If all values of a cluster are equal, their mean is exactly this
/// value.
std::vector<double> cluster_means(const Clusters& clusters);

/// Relative tolerance of equality. Values that differ by less than this share of the largest value count as equal, so
/// rounding affects neither ranks nor intervals.
inline constexpr double kRounding = 1e-12;

/// The mean of a sample with a two-sided 95 % interval of the true mean.
struct MeanEstimate {
  std::size_t count = 0;     ///< number of values
  std::size_t clusters = 0;  ///< number of clusters, which decides the width of the interval
  double mean = 0.0;         ///< mean of all values; 0 if there are none
  std::optional<MeanInterval> interval;
};

/// Returns the influence of each cluster on the mean of all values: (mean of the cluster - `mean`) times the size of
/// the cluster, divided by the average size. The influences sum to 0. They do not change if every value of all clusters
/// is repeated.
std::vector<double> cluster_influences(const Clusters& clusters, double mean);

/// Returns whether the means of all clusters are equal within kRounding. A sample with equal means has no interval,
/// however large it is, because it shows no spread. `scale` is the largest absolute value of the numbers from which the
/// values were computed. It matters if the values are differences of large numbers.
bool all_equal(const Clusters& clusters, double scale = 0.0);

/// Standard deviation of the independent units of a sample, which are its clusters.
struct UnitSpread {
  /// Standard deviation of the influences of the clusters (cluster_influences()). If all clusters have the same size,
  /// this is the standard deviation of their means.
  double sd = 0.0;
  /// Degrees of freedom of the chi-square distribution whose relative variance is that of `sd` squared: one less than
  /// there are clusters for Gaussian influences, and fewer for heavy tails (O'Neill 2014, Some useful moment results in
  /// sampling problems, The American Statistician 68). Light tails count as Gaussian, because the kurtosis of a small
  /// sample is noisy.
  double degrees = 0.0;
  MeanInterval interval;  ///< 95 % interval of the true standard deviation, from this chi-square distribution
};

/// Returns the spread of the clusters; nullopt for fewer than two clusters and for clusters that are all_equal().
std::optional<UnitSpread> spread_of_units(const Clusters& clusters, double scale = 0.0);

/// Returns the standard deviation with which units_needed() gives a number whose true power, averaged over samples like
/// this one, is `power`. It exceeds `sd`, because a small `sd` loses more power than a large `sd` gains. The factor is
/// 1.046 for 20 Gaussian units and 80 % power. It is exact if many Gaussian units are needed (Julious and Owen 2006,
/// Sample size calculations for clinical studies allowing for uncertainty about the variance, Pharmaceutical
/// Statistics 5).
double planning_sd(const UnitSpread& spread, double power);

/// Returns the mean of `units` Gaussian differences, divided by their standard deviation, at which a two-sided paired t
/// test at 5 % has this power (noncentral t; Cohen 1988, Statistical power analysis for the behavioral sciences,
/// chapter 2). The test can also find a difference of the wrong sign; this probability, below 1e-4, is left out.
/// `units` must be at least 2, and `power` from 0.5 to 0.99.
double detectable_effect(std::size_t units, double power);

/// Returns the smallest number of units whose detectable_effect() is at most `effect`: at least 6 and at most 2^30.
/// The signed-rank test of `palpate compare` has no p below 5 % for fewer than 6 units.
std::size_t units_needed(double effect, double power);

/// Returns the mean of finite values, in which each value has the same weight. The interval is Student's t with one
/// degree of freedom less than there are clusters. The standard error is that of a ratio estimator (Cochran 1977,
/// Sampling techniques, section 9A.1). One cluster, or clusters that are all_equal(), have no interval.
MeanEstimate estimate_mean(const Clusters& clusters, double scale = 0.0);

/// Returns the ratio of half the interval of estimate_mean() to the standard error: 12.706 for one degree of freedom,
/// 1.960 in the limit. `degrees` must be at least 1.
double student_factor(std::size_t degrees);

/// Return the probability that Student's t with `degrees` degrees of freedom exceeds `value`, and the value that it
/// exceeds with probability 1 - `share`.
double student_tail(double value, double degrees);
double student_quantile(double share, double degrees);

/// Returns the quantile of the standard normal distribution for a probability between 0 and 1.
double normal_quantile(double share);

}  // namespace palpate
