// SPDX-License-Identifier: MIT
// Output of comparisons: text tables with remarks, tables of means in Markdown and LaTeX, and rows for programs.
#pragma once

#include "analysis/compare.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns a table with one line per group, a table with one line per pair, and remarks, in readable units.
std::string compare_tables(const Comparison& comparison);

/// Returns the explanation of intervals, p and effects for such tables.
std::string compare_legend(const std::vector<Comparison>& comparisons);

/// Returns a Markdown table of means for a paper or README: one row per group and number of taps, one column per metric
/// with its unit. Remarks on missing values follow the table. The comparisons have the same groups; comparisons at the
/// same occasion stand together, each occasion with the same metrics in the same order.
std::string means_table(const std::vector<Comparison>& comparisons);
/// Returns the same as LaTeX for the package booktabs: means with intervals, and n, the number of jobs with a value.
/// LaTeX comments before the table explain the numbers and list missing values.
std::string latex_table(const std::vector<Comparison>& comparisons);

/// Returns one row per group, then one row per pair, in SI units. `where` is the text of the condition, "" for none.
std::vector<Row> compare_rows(const Comparison& comparison, const std::string& where);

}  // namespace palpate
