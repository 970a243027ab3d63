// SPDX-License-Identifier: MIT
// Means of several metrics in one table, as Markdown: what a paper or a README shows of a sweep.
#pragma once

#include "analysis/compare.hpp"

#include <string>
#include <vector>

namespace palpate {

/// A row a group and number of taps, a column a metric, in one readable unit each; below it, what is not in the means.
/// `comparisons` have the same groups; those with the same `after_taps` stand together, each with the same metrics in
/// the same order.
std::string means_table(const std::vector<Comparison>& comparisons);

}  // namespace palpate
