// SPDX-License-Identifier: MIT
// The results of a sweep as if its jobs had ended earlier: at given checkpoints.
#pragma once

#include "record/evaluation_point.hpp"
#include "sweep/tap_summaries.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace palpate {

/// Column that shows whether a job reached the goal of --until.
inline constexpr const char* kReached = "reached";

/// Returns the results at each checkpoint in `occasions`, and writes them as results_<key>.csv into the sweep's
/// directory. A job that has failed or has not reached a checkpoint has its final row. For a checkpoint with a goal,
/// the column `reached` shows which jobs reached the goal.
///
/// `complete` must compute the missing summaries. If `complete` returns false, the result is nullopt. Throws Error for
/// a number of taps that no job made, and for a damaged sweep.
std::optional<std::vector<std::vector<Row>>> results_at(const Sweep& sweep, const std::vector<Checkpoint>& occasions,
                                                        const std::function<bool(const TapSummaries&)>& complete);

}  // namespace palpate
