// SPDX-License-Identifier: MIT
#include "analysis/statistics.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <cmath>

namespace palpate {

double student_factor(std::size_t degrees) {
  constexpr double kTail = 0.025;
  const boost::math::students_t_distribution<double> distribution(static_cast<double>(degrees));
  return boost::math::quantile(boost::math::complement(distribution, kTail));
}

MeanEstimate estimate_mean(const std::vector<double>& values) {
  MeanEstimate out;
  out.count = values.size();
  out.mean = mean_of(values);
  if (values.size() < 2) return out;
  const auto n = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) squares += (value - out.mean) * (value - out.mean);
  const double half = student_factor(values.size() - 1) * std::sqrt(squares / (n - 1.0) / n);
  out.interval = MeanInterval{out.mean - half, out.mean + half};
  return out;
}

double normal_quantile(double share) {
  return boost::math::quantile(boost::math::normal_distribution<double>(), share);
}

}  // namespace palpate
