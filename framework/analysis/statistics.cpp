// SPDX-License-Identifier: MIT
#include "analysis/statistics.hpp"

#include <boost/iterator/counting_iterator.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

namespace {

/// Computes in double precision: long double would not improve an interval, and some machines lack it.
using Doubles = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

std::size_t count_of(const Clusters& clusters) {
  return std::accumulate(clusters.begin(), clusters.end(), std::size_t{0},
                         [](std::size_t sum, const std::vector<double>& one) { return sum + one.size(); });
}

/// Returns the mean of all values.
double mean_of_clusters(const Clusters& clusters) {
  const std::vector<double> means = cluster_means(clusters);
  // If all clusters have the same size or the same mean, the mean of the means avoids the rounding errors of the
  // general formula.
  const auto same_size = [&](const std::vector<double>& one) { return one.size() == clusters.front().size(); };
  const auto equal = [&](double one) { return one == means.front(); };
  if (std::all_of(clusters.begin(), clusters.end(), same_size) || std::all_of(means.begin(), means.end(), equal))
    return mean_of(means);
  const auto count = static_cast<double>(count_of(clusters));
  double out = 0.0;
  for (std::size_t i = 0; i < means.size(); ++i) out += means[i] * (static_cast<double>(clusters[i].size()) / count);
  return out;
}

using StudentsT = boost::math::students_t_distribution<double, Doubles>;
using NoncentralT = boost::math::non_central_t_distribution<double, Doubles>;

}  // namespace

double student_tail(double value, double degrees) {
  return boost::math::cdf(boost::math::complement(StudentsT(degrees), value));
}

double student_quantile(double share, double degrees) { return boost::math::quantile(StudentsT(degrees), share); }

double student_factor(std::size_t degrees) { return student_quantile(0.975, static_cast<double>(degrees)); }

std::vector<double> cluster_means(const Clusters& clusters) {
  std::vector<double> out;
  for (const std::vector<double>& one : clusters) out.push_back(mean_of(one));
  return out;
}

std::vector<double> cluster_influences(const Clusters& clusters, double mean) {
  const double average = static_cast<double>(count_of(clusters)) / static_cast<double>(clusters.size());
  std::vector<double> out;
  for (const std::vector<double>& one : clusters)
    out.push_back((mean_of(one) - mean) * (static_cast<double>(one.size()) / average));
  return out;
}

bool all_equal(const Clusters& clusters, double scale) {
  if (clusters.empty()) return true;
  for (const std::vector<double>& one : clusters) {
    for (const double value : one) scale = std::max(scale, std::abs(value));
  }
  const std::vector<double> means = cluster_means(clusters);
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  return *most - *least <= kRounding * scale;
}

std::optional<UnitSpread> spread_of_units(const Clusters& clusters, double scale) {
  if (clusters.size() < 2 || all_equal(clusters, scale)) return std::nullopt;
  const auto n = static_cast<double>(clusters.size());
  double squares = 0.0;
  double fourths = 0.0;
  for (const double one : cluster_influences(clusters, mean_of_clusters(clusters))) {
    squares += one * one;
    fourths += one * one * one * one;
  }
  // The usual estimate of the excess kurtosis, which needs four values. max() returns 0 if the powers overflow.
  const double excess =
      n < 4.0 ? 0.0 : (n - 1.0) / (n - 2.0) / (n - 3.0) * ((n + 1.0) * (n * fourths / squares / squares - 3.0) + 6.0);
  UnitSpread out{std::sqrt(squares / (n - 1.0)), 2.0 / (2.0 / (n - 1.0) + std::max(0.0, excess) / n), {}};
  const boost::math::chi_squared_distribution<double, Doubles> distribution(out.degrees);
  out.interval.low = out.sd * std::sqrt(out.degrees / quantile(distribution, 0.975));
  out.interval.high = out.sd * std::sqrt(out.degrees / quantile(distribution, 0.025));
  return out;
}

double detectable_effect(std::size_t units, double power) {
  const auto n = static_cast<double>(units);
  const double critical = student_factor(units - 1);
  const auto excess_power = [&](double noncentrality) {
    return cdf(complement(NoncentralT(n - 1.0, noncentrality), critical)) - power;
  };
  const boost::math::tools::eps_tolerance<double> precise(32);
  return boost::math::tools::bisect(excess_power, 0.0, 100.0, precise).second / std::sqrt(n);
}

std::size_t units_needed(double effect, double power) {
  using Count = boost::counting_iterator<std::size_t>;
  return *std::partition_point(Count(6), Count(1UL << 30),
                               [&](auto n) { return detectable_effect(n, power) > effect; });
}

double planning_sd(const UnitSpread& spread, double power) {
  const double z = normal_quantile(0.975);
  return spread.sd * quantile(NoncentralT(spread.degrees, z), power) / (z + normal_quantile(power));
}

MeanEstimate estimate_mean(const Clusters& clusters, double scale) {
  MeanEstimate out{count_of(clusters), clusters.size(), mean_of_clusters(clusters), std::nullopt};
  const std::optional<UnitSpread> spread = spread_of_units(clusters, scale);
  if (!spread) return out;
  const double half = student_factor(out.clusters - 1) * spread->sd / std::sqrt(static_cast<double>(out.clusters));
  out.interval = MeanInterval{out.mean - half, out.mean + half};
  return out;
}

double normal_quantile(double share) {
  return boost::math::quantile(boost::math::normal_distribution<double, Doubles>(), share);
}

}  // namespace palpate
