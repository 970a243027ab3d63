// SPDX-License-Identifier: MIT
#include "record/quantiles.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpate {

double mean_of(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  // Equal values are not summed, because rounding errors could change the mean.
  if (*least == *most) return *least;
  // The terms are value/n, because the sum of the values could overflow.
  const auto n = static_cast<double>(values.size());
  return std::accumulate(values.begin(), values.end(), 0.0, [n](double sum, double one) { return sum + one / n; });
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(below);
  // This avoids infinity times zero if the neighbour with weight zero is infinite.
  if (part == 0.0 || sorted[below] == sorted[below + 1]) return sorted[below];
  return (1.0 - part) * sorted[below] + part * sorted[below + 1];
}

}  // namespace palpate
