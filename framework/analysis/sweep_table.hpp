// SPDX-License-Identifier: MIT
// The table at the end of a sweep.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Returns one line per group of all keys that vary except the seed: starts without contact, medians and spreads of
/// taps on the object, RMSE and IoU. Groups of a scene stand together, sorted by median RMSE. `initial_taps` returns
/// the number of initial taps of a job, which may be swept; nullopt if unknown. Returns "" if no job has ended.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate
