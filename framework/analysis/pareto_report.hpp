// SPDX-License-Identifier: MIT
// Output of a Pareto front: a table, machine-readable rows (CSV, JSON), a gnuplot script, and texts about a single
// setting.
#pragma once

#include "analysis/pareto.hpp"

#include <optional>
#include <string>

namespace palpate {

/// Returns the number of units of statistics (StatisticalUnits) per setting: "20 seeds", "18 to 20 seeds". If the seed
/// is not swept, the units are jobs.
std::string seeds_words(const Pareto& pareto);

/// Returns a table with one line per setting in readable units, the numbers on the front, and remarks.
std::string pareto_table(const Pareto& pareto);

/// Returns one row per setting. A row has the number on the front, keys, counts of jobs, means, and ends of the
/// intervals, in SI units.
std::vector<Row> pareto_rows(const Pareto& pareto);

/// Returns a gnuplot script that does not set terminal and output. The script draws every setting with its intervals,
/// the front as a numbered step line, and the names of the settings on the front. It draws `bound` as a line and marks
/// the setting `chosen`; `chosen` may be null.
std::string pareto_script(const Pareto& pareto, const std::string& title, const std::optional<double>& bound,
                          const Setting* chosen);

/// Width and height of the picture, pixels.
inline constexpr int kParetoWidth = 1300;
inline constexpr int kParetoHeight = 760;

/// Returns the error or the cost of a setting as text: "nlpd 4.31 [4.02, 4.60]".
std::string error_words(const Pareto& pareto, const Setting& setting);
std::string cost_words(const Pareto& pareto, const Setting& setting);

/// Returns "5 mm" for a value of the error.
std::string bound_words(const Pareto& pareto, double bound);

}  // namespace palpate
