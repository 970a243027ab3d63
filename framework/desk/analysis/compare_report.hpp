// SPDX-License-Identifier: MIT
// A comparison for people, as tables with a word on how to read them or one of the means alone, and for programs, as
// rows.
#pragma once

#include "analysis/compare.hpp"

#include <string>
#include <vector>

namespace palpate {

/// The groups, a line each, and below them the pairs, in readable units; then what needs a remark.
std::string compare_tables(const Comparison& comparison);

/// What the intervals, p and effects of such tables mean.
std::string compare_legend(const std::vector<Comparison>& comparisons);

/// Means of several metrics in one table, what a paper or a README shows of a sweep: a row a group and number of taps,
/// a column a metric, in one readable unit each. `comparisons` have the same groups; those at the same occasion stand
/// together, each with the same metrics in the same order.
///
/// As Markdown, the means alone; below it, what is not in them.
std::string means_table(const std::vector<Comparison>& comparisons);
/// As LaTeX for the package booktabs: means with their intervals and n, jobs with a value; before it, as comments, what
/// these are, and what is not in them.
std::string latex_table(const std::vector<Comparison>& comparisons);

/// A row a group, then a row a pair, in SI units. `where` is the condition as it was written, "" for none.
std::vector<Row> compare_rows(const Comparison& comparison, const std::string& where);

}  // namespace palpate
