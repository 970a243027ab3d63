// SPDX-License-Identifier: MIT
// The curves on the page of a sweep: those of analysis/group_curves.hpp, for every choice that the page offers.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

namespace palpate {

/// Returns {metrics, by, sets}: the names to choose from, and for each metric, axis and keys {metric, against, by,
/// over, remarks, curves: [{scene, name, at, mean, low, high, jobs}]} in SI units, intervals by Student's t as
/// everywhere on the page. Null where nobody has computed what the jobs had come to after each tap (`palpate curves`
/// does), where no key has few enough groups, and of more jobs than a page has. Throws Error for a damaged record.
Json json_of_curves(const Sweep& sweep);

}  // namespace palpate
