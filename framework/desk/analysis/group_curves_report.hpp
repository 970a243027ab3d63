// SPDX-License-Identifier: MIT
// Curves of groups for people, as a table with a word on how to read it, and for programs, as rows. The picture is in
// report/figures.
#pragma once

#include "analysis/group_curves.hpp"
#include "analysis/mean_output.hpp"
#include "record/row.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns the unit and digits in which the means of all curves are read best.
Scale metric_scale(const GroupCurves& curves);

/// Returns "12 seeds", "10 to 12 seeds", or jobs where the seed is not swept: the units at the points.
std::string curve_units_words(const GroupCurves& curves);

/// One line per group with its mean and interval at four places along the axis; then what is in no mean.
std::string curves_table(const GroupCurves& curves);

/// What is in no point, or not in all: jobs that failed or ended early, and few units; a line each.
std::string curve_remarks(const GroupCurves& curves);

/// One row per point of each curve, in SI units: `metric`, `against`, the keys of scene and group, `at` (taps or
/// seconds), `n`, `units`, `mean`, `low_95`, `high_95`, and of the group `jobs`, `left_out`, `failed`, `unfinished`,
/// `without_value` and `ended`.
std::vector<Row> curves_rows(const GroupCurves& curves);

}  // namespace palpate
