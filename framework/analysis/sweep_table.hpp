// SPDX-License-Identifier: MIT
// What a sweep comes to at a glance: the table at its end.
#pragma once

#include "sweep/sweep.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Median, spread and dead starts by group: all swept keys but the seed. One line a group under a header.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, int initial_taps);

}  // namespace palpate
