// SPDX-License-Identifier: MIT
// results.csv as it would be, had the jobs of a sweep stopped earlier.
#pragma once

#include "record/occasion.hpp"
#include "sweep/tap_summaries.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace palpate {

/// What says of a row at a goal whether the job has got there.
inline constexpr const char* kReached = "reached";

/// Returns the rows at each of the occasions, which are also left as results_<key>.csv in the sweep's directory. A job
/// for which an occasion has not come has its own row, and so has one that failed; where that cannot be seen, `reached`
/// says so. `complete` has what is missing computed; where it returns false, so does this return none. Throws Error for
/// a number of taps that no job reached, and for a damaged sweep.
std::optional<std::vector<std::vector<Row>>> results_at(const Sweep& sweep, const std::vector<Occasion>& occasions,
                                                        const std::function<bool(const TapSummaries&)>& complete);

}  // namespace palpate
