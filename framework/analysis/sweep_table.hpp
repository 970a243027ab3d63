// SPDX-License-Identifier: MIT
// The table at the end of a sweep.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Returns the number of initial taps of a job, which may be a swept key; nullopt if the number is unknown. `result`:
/// result of the job.
using InitialTaps = std::function<std::optional<int>(std::size_t job, const Row& result)>;

/// Returns one line per group of jobs; all keys that vary except the seed form the groups. A line has the number of
/// starts without a contact, medians and quantiles of object taps, RMSE and IoU. The groups of a scene are adjacent and
/// sorted by their median RMSE. Returns "" if no job has ended.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, const InitialTaps& initial_taps);

}  // namespace palpate
