// SPDX-License-Identifier: MIT
// The race of `palpate tune` on the page of its sweep. web/sweep_race.js draws the data.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"

namespace palpate {

/// Returns the settings with their jobs, their values of the tuned keys and remarks, and the keys. Returns null if the
/// sweep has no rounds. Throws Error for a damaged record.
Json json_of_race(const Sweep& sweep);

}  // namespace palpate
