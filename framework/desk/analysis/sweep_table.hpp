// SPDX-License-Identifier: MIT
// What a sweep comes to at a glance: the table at its end.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Medians and spreads of taps on the object, RMSE and IoU, and starts without contact, by group: all
/// keys that vary but the seed.
/// One line per group under a header; those of a scene stand together, the least median RMSE first. How many taps of a
/// job are initial may be swept, so it is asked of the first jobs of each group, until one tells.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate
