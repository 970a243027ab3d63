// SPDX-License-Identifier: MIT
// What is said of a sample without estimating anything: its mean and its quantiles.
#pragma once

#include <vector>

namespace palpate {

/// Of finite values; 0 of none. Equal values are their own mean, to the bit.
double mean_of(const std::vector<double>& values);

/// Linear interpolation between order statistics; `share` 0 is the least value, 0.5 the median, 1 the largest. `sorted`
/// holds at least one value; infinite ones are allowed, and what lies between a finite value and one of them is
/// infinite.
double quantile(const std::vector<double>& sorted, double share);

}  // namespace palpate
