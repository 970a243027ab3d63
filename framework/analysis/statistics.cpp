// SPDX-License-Identifier: MIT
#include "analysis/statistics.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

double student_factor(std::size_t degrees) {
  constexpr double kTail = 0.025;
  const boost::math::students_t_distribution<double> distribution(static_cast<double>(degrees));
  return boost::math::quantile(boost::math::complement(distribution, kTail));
}

MeanEstimate estimate_mean(const std::vector<double>& values) {
  MeanEstimate out;
  out.count = values.size();
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  // Shares of the mean are added: a sum could overflow where the mean does not. Equal values are their own mean, which
  // a sum rounds away from.
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  out.mean = *least == *most ? *least : std::accumulate(values.begin(), values.end(), 0.0, [n](double sum, double one) {
    return sum + one / n;
  });
  if (values.size() < 2) return out;
  double squares = 0.0;
  for (const double value : values) squares += (value - out.mean) * (value - out.mean);
  const double half = student_factor(values.size() - 1) * std::sqrt(squares / (n - 1.0) / n);
  out.interval = MeanInterval{out.mean - half, out.mean + half};
  return out;
}

double normal_quantile(double share) {
  return boost::math::quantile(boost::math::normal_distribution<double>(), share);
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(below);
  // An infinite neighbour without a part in it would give infinity times zero.
  if (part == 0.0 || sorted[below] == sorted[below + 1]) return sorted[below];
  return (1.0 - part) * sorted[below] + part * sorted[below + 1];
}

}  // namespace palpate
