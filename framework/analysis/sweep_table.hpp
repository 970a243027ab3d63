// SPDX-License-Identifier: MIT
// The table at the end of a sweep.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Returns one line per group of jobs; all keys that vary except the seed form the groups. A line has the number of
/// starts without a contact, medians and quantiles of object taps, RMSE and IoU. The groups of a scene are adjacent and
/// sorted by their median RMSE. `initial_taps` returns the number of initial taps of a job, which may be a swept key.
/// It returns nullopt if the number is unknown. Returns "" if no job has ended.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate
