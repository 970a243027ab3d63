// SPDX-License-Identifier: MIT
// The curves on the page of a sweep: analysis/group_curves.hpp for every choice of metric, axis and keys.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

namespace palpate {

/// Returns {metrics, by, sets}. `metrics` and `by` are the choices; `sets` has for each metric, axis and choice of keys
/// {metric, against, by, over, remarks, curves: [{scene, name, at, mean, low, high, jobs}]} in SI units. Intervals are
/// Student's t, as everywhere on the page. Returns null if the values after each tap are not stored (`palpate curves`
/// stores them), if every choice has too many groups, or if the page has no room for all jobs. Throws Error for a
/// damaged record.
Json json_of_curves(const Sweep& sweep);

}  // namespace palpate
