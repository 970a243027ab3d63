// SPDX-License-Identifier: MIT
// What a sample says of the mean that it comes from.
#pragma once

#include "record/sample.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// Two ends, the low one first.
struct MeanInterval {
  double low = 0.0;
  double high = 0.0;
};

/// The values of a sample, by cluster: values of one cluster may depend on each other, those of different clusters do
/// not (jobs with the same seed are a cluster). No cluster is empty.
using Clusters = std::vector<std::vector<double>>;

/// The means of the clusters, in their order. Equal values are their own mean, to the bit.
std::vector<double> cluster_means(const Clusters& clusters);

/// Values that differ by less than this share of the largest one are equal: rounding decides no rank and no interval.
inline constexpr double kRounding = 1e-12;

/// The mean of a sample, and the two-sided 95 % interval of what it estimates.
struct MeanEstimate {
  std::size_t count = 0;     ///< of values
  std::size_t clusters = 0;  ///< of clusters, which alone decide how wide the interval is
  double mean = 0.0;         ///< of all values; 0 of none
  std::optional<MeanInterval> interval;
};

/// How far a cluster pulls the mean of all values from `mean`: (mean of the cluster - `mean`) times its number of
/// values over the average number. Their sum is 0, and one that repeats each of its values weighs the same where all
/// do.
std::vector<double> cluster_influences(const Clusters& clusters, double mean);

/// Returns whether the means of all clusters are equal but for kRounding. Equal means do not tell how far the next one
/// may lie, so there is no interval of them, however many they are. `scale`: the largest absolute value of the numbers
/// that the values were computed from, where it is larger than theirs (differences of large numbers).
bool all_equal(const Clusters& clusters, double scale = 0.0);

/// The mean of finite values, each cluster with the weight of its values, and Student's interval with clusters - 1
/// degrees of freedom; the standard error is that of a ratio estimator (Cochran 1977, Sampling techniques, section
/// 9A.1). No interval of one cluster, nor of clusters that are all_equal().
MeanEstimate estimate_mean(const Clusters& clusters, double scale = 0.0);

/// The factor of the standard error in that interval: 12.706 for one degree of freedom, 1.960 for infinitely many.
/// `degrees` >= 1.
double student_factor(std::size_t degrees);

/// The place that a standard normal variable stays below with this probability, which is between 0 and 1.
double normal_quantile(double share);

}  // namespace palpate
