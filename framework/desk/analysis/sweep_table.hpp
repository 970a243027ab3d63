// SPDX-License-Identifier: MIT
// What a sweep comes to at a glance: the table at its end.
#pragma once

#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Median, spread and dead starts by group: all swept keys but the seed. One line a group under a header. How many taps
/// of a job are initial may be swept, so it is asked of the first job of each group.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate
