// SPDX-License-Identifier: MIT
// The table at the end of a sweep.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Function that returns the number of initial taps of a job; nullopt if unknown. The number may be a swept key, so it
/// may differ between jobs. `result`: the job's row of results.csv.
using InitialTaps = std::function<std::optional<int>(std::size_t job, const Row& result)>;

/// Returns one line per group of jobs. Jobs with equal values of all varying keys except the seed form a group. A line
/// has the share of runs without an initial tap on an object, and medians and quantiles of object taps, RMSE and IoU.
/// The groups of a scene are adjacent and sorted by their median RMSE. Returns "" if no job has ended.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, const InitialTaps& initial_taps);

}  // namespace palpate
