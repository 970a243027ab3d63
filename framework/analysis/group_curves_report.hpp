// SPDX-License-Identifier: MIT
// Output of group curves: a table with remarks, and machine-readable rows (CSV, JSON). The picture of the curves is in
// report/figures.
#pragma once

#include "analysis/group_curves.hpp"
#include "analysis/mean_output.hpp"
#include "record/row.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns the unit and the number of digits for the means of all curves.
DisplayScale metric_scale(const GroupCurves& curves);

/// Returns the number of units of statistics (StatisticalUnits) at the points: "12 seeds", "10 to 12 seeds". If the
/// seed is not swept, the units are jobs.
std::string curve_units_words(const GroupCurves& curves);

/// Returns a table with one line per group, followed by the remarks. A line has the mean and its interval at four
/// points along the axis.
std::string curves_table(const GroupCurves& curves);

/// Returns remarks, one per line. They report jobs that are missing at some or all points, jobs that ended early, and a
/// small number of units.
std::string curve_remarks(const GroupCurves& curves);

/// Returns one row per point of each curve, in SI units. A row has `metric`, `against`, the keys of scene and group,
/// `at` (taps or seconds), `n`, `units`, `mean`, `low_95` and `high_95`. It also has the counts `jobs`, `left_out`,
/// `failed`, `unfinished`, `without_value` and `ended` of the group.
std::vector<Row> curves_rows(const GroupCurves& curves);

}  // namespace palpate
