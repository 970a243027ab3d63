// SPDX-License-Identifier: MIT
// Output of comparisons: text tables with remarks, tables of means in Markdown and LaTeX, and machine-readable rows
// (CSV, JSON).
#pragma once

#include "analysis/compare.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns a table with one line per group, a table with one line per pair, and remarks. Numbers have readable units.
std::string compare_tables(const Comparison& comparison);

/// Returns an explanation of intervals, p and effects, which is printed below the tables.
std::string compare_legend(const std::vector<Comparison>& comparisons);

/// Returns a table of the seeds that each pair needs for a true difference of `difference` (SI units) with this power,
/// and an explanation. Throws Error if the seed is not swept, and if no pair has a spread.
std::string power_table(const Comparison& comparison, double difference, double power);

/// Returns a table of means in Markdown, for a paper or a README. It has one row per group and number of taps, and one
/// column per metric with its unit. Remarks on missing values follow the table. All comparisons must have the same
/// groups. Comparisons at the same checkpoint (Comparison::occasion) must be adjacent, and each checkpoint must have
/// the same metrics in the same order.
std::string means_table(const std::vector<Comparison>& comparisons);
/// Returns the table of means_table() in LaTeX for the package booktabs. It shows means with intervals, and the number
/// n of jobs with a value. LaTeX comments before the table explain the numbers and list missing values.
std::string latex_table(const std::vector<Comparison>& comparisons);

/// Returns one row per group, followed by one row per pair, in SI units. `where` is the text of the condition, or "" if
/// there is none.
std::vector<Row> compare_rows(const Comparison& comparison, const std::string& where);

}  // namespace palpate
