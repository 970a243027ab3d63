// SPDX-License-Identifier: MIT
// The curves on the page of a sweep. analysis/group_curves.hpp computes them for every choice of metric, axis and keys.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

namespace palpate {

/// Returns {metrics, by, sets}. The reader of the page chooses one of `metrics` and one of `by`. For each choice,
/// `sets` has {metric, against, by, over, remarks, curves: [{scene, name, at, mean, low, high, jobs}]} in SI units. The
/// intervals are Student's t intervals, like all other intervals on the page. Returns null in three cases: the values
/// after each tap are not stored (`palpate curves` stores them), every choice has too many groups, or the page has no
/// room for all jobs. Throws Error for a damaged record.
Json json_of_curves(const Sweep& sweep);

}  // namespace palpate
