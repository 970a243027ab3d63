// SPDX-License-Identifier: MIT
#include "analysis/bootstrap.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

/// A cluster: how far it pulls the mean, and how many values it has over the average number.
using Pull = std::pair<double, double>;

/// The pulls of all clusters in units of the largest, in an order that depends on neither the order of the clusters nor
/// their sign; `mirrored` if they are those of the negatives.
struct Centred {
  std::vector<Pull> pulls;
  double unit = 0.0;
  bool mirrored = false;
  bool same_size = true;  ///< all clusters
};

Centred centre(const Clusters& clusters, double mean) {
  Centred out;
  std::size_t count = 0;
  for (const std::vector<double>& one : clusters) {
    count += one.size();
    out.same_size = out.same_size && one.size() == clusters.front().size();
  }
  const double average = static_cast<double>(count) / static_cast<double>(clusters.size());
  const std::vector<double> influences = cluster_influences(clusters, mean);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    out.pulls.emplace_back(influences[i], static_cast<double>(clusters[i].size()) / average);
    out.unit = std::max(out.unit, std::abs(influences[i]));
  }
  if (out.unit == 0.0 || !std::isfinite(out.unit)) return out;
  std::vector<Pull> mirror;
  for (auto& [pull, weight] : out.pulls) {
    pull /= out.unit;
    mirror.emplace_back(-pull, weight);
  }
  std::sort(out.pulls.begin(), out.pulls.end());
  std::sort(mirror.begin(), mirror.end());
  out.mirrored = mirror < out.pulls;
  if (out.mirrored) out.pulls = mirror;
  return out;
}

/// The ends of a small sample's interval lie far out among its means, where draws are few: it is drawn anew more often,
/// which costs no more than a large one does. Of a very large one, whose mean is as good as normal, fewer place the
/// ends well enough: of 2000 within 3 % of half the interval.
std::size_t resamples_of(std::size_t count) {
  constexpr std::size_t kMostDraws = 100'000'000;
  if (count > kMostDraws / kResamples) return std::max(kMostDraws / count, kResamples / 5);
  return std::clamp(10'000'000 / count, kResamples, 10 * kResamples);
}

/// Calls `take` with the place of each of `count` draws with replacement.
template <class Take>
void draw(Random& random, std::uint64_t count, const Take& take) {
  // 32 bits an index: it favours none by more than count / 2^32, and two come from one draw.
  const auto at = [&](std::uint64_t bits) { take(static_cast<std::size_t>((bits * count) >> 32)); };
  for (std::uint64_t i = 0; i + 1 < count; i += 2) {
    const std::uint64_t bits = random.bits();
    at(bits >> 32);
    at(bits & 0xffffffffU);
  }
  if (count % 2 == 1) at(random.bits() >> 32);
}

double normal_share(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// How far the median of resampled values is from their centre, in standard deviations. Those within `rounding` of it
/// count as half below.
double bias_of(const std::vector<double>& values, double centre, double rounding) {
  const auto below = std::count_if(values.begin(), values.end(), [&](double one) { return one < centre - rounding; });
  const auto above = std::count_if(values.begin(), values.end(), [&](double one) { return one > centre + rounding; });
  const auto resamples = static_cast<double>(values.size());
  const double share = 0.5 + 0.5 * static_cast<double>(below - above) / resamples;
  const double least = 0.5 / resamples;
  return normal_quantile(std::clamp(share, least, 1.0 - least));
}

/// The skewness of the influence of each value on what is estimated, as BCa takes it in.
double acceleration_of(const std::vector<double>& influences) {
  double squares = 0.0;
  double cubes = 0.0;
  for (const double one : influences) {
    squares += one * one;
    cubes += one * one * one;
  }
  return cubes / (6.0 * squares * std::sqrt(squares));
}

/// BCa of resampled values, which it reorders, about what was estimated.
MeanInterval interval_of(std::vector<double>& values, double centre, double rounding,
                         const std::vector<double>& influences) {
  const double bias = bias_of(values, centre, rounding);
  const double acceleration = acceleration_of(influences);
  const auto n = static_cast<double>(influences.size());
  const double z = student_factor(influences.size() - 1) * std::sqrt(n / (n - 1.0));
  const auto end = [&](double place) {
    const double shifted = bias + place;
    const double share = normal_share(bias + shifted / (1.0 - acceleration * shifted));
    // The two values that the quantile lies between; a whole order costs more than all draws.
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
  const Centred centred = centre(clusters, out.mean);
  if (centred.unit == 0.0 || !std::isfinite(centred.unit)) return out;
  const std::vector<Pull>& pulls = centred.pulls;
  std::vector<double> influences;
  for (const Pull& one : pulls) influences.push_back(one.first);
  Random random(0, "bootstrap");
  std::vector<double> means(resamples_of(pulls.size()));
  for (double& mean : means) {
    double sum = 0.0;
    double weight = centred.same_size ? static_cast<double>(pulls.size()) : 0.0;
    if (centred.same_size) {
      draw(random, pulls.size(), [&](std::size_t i) { sum += influences[i]; });
    } else {
      draw(random, pulls.size(), [&](std::size_t i) {
        sum += pulls[i].first;
        weight += pulls[i].second;
      });
    }
    mean = sum / weight;
  }
  const MeanInterval ends = interval_of(means, 0.0, 1e-12, influences);
  const double low = ends.low * centred.unit;
  const double high = ends.high * centred.unit;
  out.interval =
      centred.mirrored ? MeanInterval{out.mean - high, out.mean - low} : MeanInterval{out.mean + low, out.mean + high};
  return out;
}

std::optional<RatioEstimate> bootstrap_ratio(const std::vector<double>& above, const std::vector<double>& below) {
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < above.size(); ++i) pairs.emplace_back(above[i], below[i]);
  // Sorted: the order of the pairs decides nothing, neither draws nor rounding.
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
    // 0 over 0 says no more of how large the ratio may be than a positive number over 0.
    ratio = b > 0.0 ? a / b : std::numeric_limits<double>::infinity();
  }
  out.interval = interval_of(ratios, out.ratio, kRounding * out.ratio, influences);
  return out;
}

}  // namespace palpate
