// SPDX-License-Identifier: MIT
// What is said of a sample: mean with its interval, quantiles.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// Two ends, the low one first.
struct MeanInterval {
  double low = 0.0;
  double high = 0.0;
};

/// The mean of a sample, and the two-sided 95 % interval of what it estimates (Student's t, count - 1 degrees of
/// freedom). One value has no interval: nothing is known of the spread. Equal values have one without width.
struct MeanEstimate {
  std::size_t count = 0;
  double mean = 0.0;  ///< 0 of no values
  std::optional<MeanInterval> interval;
};

/// Of finite values.
MeanEstimate estimate_mean(const std::vector<double>& values);

/// The factor of the standard error in that interval: 12.706 for one degree of freedom, 1.960 for infinitely many.
/// `degrees` >= 1.
double student_factor(std::size_t degrees);

/// The place that a standard normal variable stays below with this probability, which is between 0 and 1.
double normal_quantile(double share);

/// Linear interpolation between order statistics; `share` 0 is the least value, 0.5 the median, 1 the largest. `sorted`
/// holds at least one value; infinite ones are allowed, and what lies between a finite value and one of them is
/// infinite.
double quantile(const std::vector<double>& sorted, double share);

}  // namespace palpate
