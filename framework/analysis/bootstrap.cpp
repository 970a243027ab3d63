// SPDX-License-Identifier: MIT
#include "analysis/bootstrap.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Distances from the mean in units of the largest, in an order that depends on neither the order of the values nor
/// their sign; `mirrored` if they are those of the negatives.
struct Centred {
  std::vector<double> distances;
  double unit = 0.0;
  bool mirrored = false;
};

Centred centre(const std::vector<double>& values, double mean) {
  Centred out;
  for (const double value : values) {
    out.distances.push_back(value - mean);
    out.unit = std::max(out.unit, std::abs(value - mean));
  }
  if (out.unit == 0.0 || !std::isfinite(out.unit)) return out;
  for (double& distance : out.distances) distance /= out.unit;
  std::sort(out.distances.begin(), out.distances.end());
  std::vector<double> mirror(out.distances.rbegin(), out.distances.rend());
  for (double& distance : mirror) distance = -distance;
  out.mirrored = mirror < out.distances;
  if (out.mirrored) out.distances = mirror;
  return out;
}

/// The ends of a small sample's interval lie far out among its means, where draws are few: it is drawn anew more often,
/// which costs no more than a large one does.
std::size_t resamples_of(std::size_t count) { return std::clamp(10'000'000 / count, kResamples, 10 * kResamples); }

/// The sums of samples drawn from `distances` with replacement.
std::vector<double> resampled_sums(const std::vector<double>& distances) {
  Random random(0, "bootstrap");
  const std::uint64_t count = distances.size();
  // 32 bits an index: it favours none by more than count / 2^32, and two come from one draw.
  const auto at = [&](std::uint64_t bits) { return distances[static_cast<std::size_t>((bits * count) >> 32)]; };
  std::vector<double> sums(resamples_of(distances.size()));
  for (double& sum : sums) {
    for (std::uint64_t i = 0; i + 1 < count; i += 2) {
      const std::uint64_t bits = random.bits();
      sum += at(bits >> 32) + at(bits & 0xffffffffU);
    }
    if (count % 2 == 1) sum += at(random.bits() >> 32);
  }
  return sums;
}

/// quantile() of sums that are not sorted: the two that it looks at are put where they belong.
double quantile_of(std::vector<double>& sums, double share) {
  const auto below = sums.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sums.size() - 1));
  std::nth_element(sums.begin(), below, sums.end());
  if (below + 1 != sums.end()) std::iter_swap(below + 1, std::min_element(below + 1, sums.end()));
  return quantile(sums, share);
}

double normal_share(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// How far the median of the sums is from 0, their centre, in standard deviations.
double bias_of(const std::vector<double>& sums, double count) {
  // Sums that are 0 but for rounding count as half below.
  const double rounding = 1e-12 * count;
  const auto below = std::count_if(sums.begin(), sums.end(), [&](double sum) { return sum < -rounding; });
  const auto above = std::count_if(sums.begin(), sums.end(), [&](double sum) { return sum > rounding; });
  const auto resamples = static_cast<double>(sums.size());
  const double share = 0.5 + 0.5 * static_cast<double>(below - above) / resamples;
  const double least = 0.5 / resamples;
  return normal_quantile(std::clamp(share, least, 1.0 - least));
}

}  // namespace

MeanEstimate bootstrap_mean(const std::vector<double>& values) {
  MeanEstimate out = estimate_mean(values);
  out.interval.reset();
  if (values.size() < kLeastForInterval) return out;
  const Centred centred = centre(values, out.mean);
  if (centred.unit == 0.0 || !std::isfinite(centred.unit)) return out;
  const auto count = static_cast<double>(values.size());
  std::vector<double> sums = resampled_sums(centred.distances);
  double squares = 0.0;
  double cubes = 0.0;
  for (const double distance : centred.distances) {
    squares += distance * distance;
    cubes += distance * distance * distance;
  }
  const double acceleration = cubes / (6.0 * squares * std::sqrt(squares));
  const double bias = bias_of(sums, count);
  const double z = student_factor(values.size() - 1) * std::sqrt(count / (count - 1.0));
  const auto end = [&](double side) {
    const double shifted = bias + side * z;
    const double share = normal_share(bias + shifted / (1.0 - acceleration * shifted));
    return quantile_of(sums, share) * centred.unit / count;
  };
  const double low = end(-1.0);
  const double high = end(1.0);
  out.interval =
      centred.mirrored ? MeanInterval{out.mean - high, out.mean - low} : MeanInterval{out.mean + low, out.mean + high};
  return out;
}

}  // namespace palpate
