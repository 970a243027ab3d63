// SPDX-License-Identifier: MIT
// Descriptive statistics of a sample: mean and quantiles.
#pragma once

#include <vector>

namespace palpate {

/// Returns the mean of finite values; 0 without values. The mean of equal values is exactly that value.
double mean_of(const std::vector<double>& values);

/// Returns a quantile by linear interpolation between order statistics: `share` 0 is the least value, 0.5 the median, 1
/// the largest. `sorted` must have at least one value. Values may be infinite; a quantile between a finite and an
/// infinite value is infinite.
double quantile(const std::vector<double>& sorted, double share);

}  // namespace palpate
