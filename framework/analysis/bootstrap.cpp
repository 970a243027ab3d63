// SPDX-License-Identifier: MIT
#include "analysis/bootstrap.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

/// Influence of a cluster on the mean, and size of the cluster divided by the average size.
using ClusterInfluence = std::pair<double, double>;

/// The influences of all clusters, divided by the largest absolute influence and sorted. If the negated influences come
/// first in lexicographic order, `influences` has the negated influences, and `mirrored` is set. Therefore, neither the
/// order of the clusters nor the sign of the values changes the draws.
struct ScaledInfluences {
  std::vector<ClusterInfluence> influences;
  double unit = 0.0;
  bool mirrored = false;
  bool same_size = true;  ///< whether all clusters have the same size
};

ScaledInfluences scale_influences(const Clusters& clusters, double mean) {
  ScaledInfluences out;
  std::size_t count = 0;
  for (const std::vector<double>& one : clusters) {
    count += one.size();
    out.same_size = out.same_size && one.size() == clusters.front().size();
  }
  const double average = static_cast<double>(count) / static_cast<double>(clusters.size());
  const std::vector<double> influences = cluster_influences(clusters, mean);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    out.influences.emplace_back(influences[i], static_cast<double>(clusters[i].size()) / average);
    out.unit = std::max(out.unit, std::abs(influences[i]));
  }
  if (out.unit == 0.0 || !std::isfinite(out.unit)) return out;
  std::vector<ClusterInfluence> mirror;
  for (auto& [influence, weight] : out.influences) {
    influence /= out.unit;
    mirror.emplace_back(-influence, weight);
  }
  std::sort(out.influences.begin(), out.influences.end());
  std::sort(mirror.begin(), mirror.end());
  out.mirrored = mirror < out.influences;
  if (out.mirrored) out.influences = mirror;
  return out;
}

/// Returns the number of resamples for this number of clusters. A small sample gets more resamples, because the ends of
/// its interval are far out in the distribution of resampled means, where draws are few. A very large sample gets fewer
/// resamples, because 2000 suffice: they determine the ends within 3 % of half the interval.
std::size_t resamples_of(std::size_t count) {
  constexpr std::size_t kMostDraws = 100'000'000;
  if (count > kMostDraws / kResamples) return std::max(kMostDraws / count, kResamples / 5);
  return std::clamp(10'000'000 / count, kResamples, 10 * kResamples);
}

/// Draws `count` indices below `count` with replacement and calls `take` with each.
template <class Take>
void draw(Random& random, std::uint64_t count, const Take& take) {
  // Each index uses 32 bits, so a 64-bit random number gives two indices. The probability of an index is off by at most
  // count / 2^32, relative to 1 / count.
  const auto at = [&](std::uint64_t bits) { take(static_cast<std::size_t>((bits * count) >> 32)); };
  for (std::uint64_t i = 0; i + 1 < count; i += 2) {
    const std::uint64_t bits = random.bits();
    at(bits >> 32);
    at(bits & 0xffffffffU);
  }
  if (count % 2 == 1) at(random.bits() >> 32);
}

double normal_share(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// Returns the bias correction of BCa: the distance of the median of the resampled values from `centre`, in standard
/// deviations. Half of the values within `rounding` of the centre count as below it.
double bias_of(const std::vector<double>& values, double centre, double rounding) {
  const auto below = std::count_if(values.begin(), values.end(), [&](double one) { return one < centre - rounding; });
  const auto above = std::count_if(values.begin(), values.end(), [&](double one) { return one > centre + rounding; });
  const auto resamples = static_cast<double>(values.size());
  const double share = 0.5 + 0.5 * static_cast<double>(below - above) / resamples;
  const double least = 0.5 / resamples;
  return normal_quantile(std::clamp(share, least, 1.0 - least));
}

/// Returns the acceleration of BCa, which is proportional to the skewness of the influences.
double acceleration_of(const std::vector<double>& influences) {
  double squares = 0.0;
  double cubes = 0.0;
  for (const double one : influences) {
    squares += one * one;
    cubes += one * one * one;
  }
  return cubes / (6.0 * squares * std::sqrt(squares));
}

/// Returns the BCa interval of the estimate `centre`. `values`: the estimates of all resamples, which are reordered.
/// Values within `rounding` of `centre` count as equal to it.
MeanInterval interval_of(std::vector<double>& values, double centre, double rounding,
                         const std::vector<double>& influences) {
  const double bias = bias_of(values, centre, rounding);
  const double acceleration = acceleration_of(influences);
  const auto n = static_cast<double>(influences.size());
  const double z = student_factor(influences.size() - 1) * std::sqrt(n / (n - 1.0));
  const auto end = [&](double place) {
    const double shifted = bias + place;
    const double share = normal_share(bias + shifted / (1.0 - acceleration * shifted));
    // Finds only the two values around the quantile, because sorting all values would take longer than all draws.
    const auto below = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + below, values.end());
    if (below + 1 < static_cast<std::ptrdiff_t>(values.size()))
      std::iter_swap(values.begin() + below + 1, std::min_element(values.begin() + below + 1, values.end()));
    return quantile(values, share);
  };
  return {end(-z), end(z)};
}

}  // namespace

MeanEstimate mean_of_sample(const Clusters& clusters, double scale) {
  if (clusters.size() >= kLeastForBootstrap) return bootstrap_mean(clusters, scale);
  MeanEstimate out = estimate_mean(clusters, scale);
  if (clusters.size() < kLeastForInterval) out.interval.reset();
  return out;
}

MeanEstimate bootstrap_mean(const Clusters& clusters, double scale) {
  MeanEstimate out = estimate_mean(clusters, scale);
  const bool has_spread = out.interval.has_value();
  out.interval.reset();
  if (!has_spread || clusters.size() < kLeastForInterval) return out;
  const ScaledInfluences scaled = scale_influences(clusters, out.mean);
  if (scaled.unit == 0.0 || !std::isfinite(scaled.unit)) return out;
  const std::vector<ClusterInfluence>& pairs = scaled.influences;
  std::vector<double> influences;
  for (const ClusterInfluence& one : pairs) influences.push_back(one.first);
  Random random(0, "bootstrap");
  std::vector<double> means(resamples_of(influences.size()));
  for (double& mean : means) {
    double sum = 0.0;
    double weight = scaled.same_size ? static_cast<double>(influences.size()) : 0.0;
    if (scaled.same_size) {
      draw(random, influences.size(), [&](std::size_t i) { sum += influences[i]; });
    } else {
      draw(random, influences.size(), [&](std::size_t i) {
        sum += pairs[i].first;
        weight += pairs[i].second;
      });
    }
    mean = sum / weight;
  }
  const MeanInterval ends = interval_of(means, 0.0, 1e-12, influences);
  const double low = ends.low * scaled.unit;
  const double high = ends.high * scaled.unit;
  out.interval =
      scaled.mirrored ? MeanInterval{out.mean - high, out.mean - low} : MeanInterval{out.mean + low, out.mean + high};
  return out;
}

std::optional<RatioEstimate> bootstrap_ratio(const std::vector<double>& above, const std::vector<double>& below) {
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < above.size(); ++i) pairs.emplace_back(above[i], below[i]);
  // Sorts the pairs, so that their order changes neither draws nor rounding.
  std::sort(pairs.begin(), pairs.end());
  double top = 0.0;
  double bottom = 0.0;
  for (const auto& [a, b] : pairs) {
    if (!std::isfinite(a) || !std::isfinite(b) || a < 0.0 || b < 0.0) return std::nullopt;
    top += a;
    bottom += b;
  }
  if (!(bottom > 0.0) || !std::isfinite(top / bottom)) return std::nullopt;
  RatioEstimate out{pairs.size(), top / bottom, std::nullopt};
  if (pairs.size() < kLeastForInterval) return out;
  std::vector<double> influences;
  for (const auto& [a, b] : pairs) influences.push_back((a - out.ratio * b) / bottom);
  const double largest = std::abs(*std::max_element(influences.begin(), influences.end(),
                                                    [](double x, double y) { return std::abs(x) < std::abs(y); }));
  if (largest <= kRounding * out.ratio) return out;
  Random random(0, "bootstrap of a ratio");
  std::vector<double> ratios(resamples_of(pairs.size()));
  for (double& ratio : ratios) {
    double a = 0.0;
    double b = 0.0;
    draw(random, pairs.size(), [&](std::size_t i) {
      a += pairs[i].first;
      b += pairs[i].second;
    });
    // A resample without a positive value in `below` counts as an infinite ratio, even if it is 0 / 0.
    ratio = b > 0.0 ? a / b : std::numeric_limits<double>::infinity();
  }
  out.interval = interval_of(ratios, out.ratio, kRounding * out.ratio, influences);
  return out;
}

}  // namespace palpate
