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

}  // namespace palpate
