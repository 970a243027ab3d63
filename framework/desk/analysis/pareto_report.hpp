// SPDX-License-Identifier: MIT
// The front of speed against accuracy for people: a table, the same as CSV, a picture, and the setting that was asked
// for as a config.
#pragma once

#include "analysis/pareto.hpp"

#include <optional>
#include <string>

namespace palpate {

/// "20 seeds", "18 to 20 seeds", or jobs where the seed is not swept: the units that the means of a setting are over.
std::string seeds_words(const Pareto& pareto);

/// One line a setting under a header, in readable units, with the number of those on the front.
std::string pareto_table(const Pareto& pareto);

/// One row a setting: number on the front, keys, counts of jobs, means and ends of the intervals in SI units.
std::vector<Row> pareto_rows(const Pareto& pareto);

/// A gnuplot script without terminal and output: every setting with its intervals, the front as a numbered step line
/// with a list of names, `bound` (if any) as a line, `chosen` (may be null) marked.
std::string pareto_script(const Pareto& pareto, const std::string& title, const std::optional<double>& bound,
                          const Setting* chosen);

/// The width and height in pixels that the script is made for.
inline constexpr int kParetoWidth = 1300;
inline constexpr int kParetoHeight = 760;

/// Of one setting in words: "nlpd 4.31 [4.02, 4.60]".
std::string error_words(const Pareto& pareto, const Setting& setting);
std::string cost_words(const Pareto& pareto, const Setting& setting);

/// "5 mm" of an error of this sweep.
std::string bound_words(const Pareto& pareto, double bound);

}  // namespace palpate
