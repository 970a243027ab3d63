// SPDX-License-Identifier: MIT
// Explanation of a recorded tap in words.
#pragma once

#include "record/run_replay.hpp"

#include <string>

namespace palpate {

/// Returns about twenty lines about tap `tap` (counted from 1) of a recorded run. They have the reason of its choice,
/// the models at that time, the expected and the actual result, and the effect of the tap. All values are recorded
/// ones, except the expected height, which is computed from the earlier taps. Throws Error if there is no such tap.
std::string explain_tap(const RunEnvironment& environment, const RecordedRun& recording, int tap);

}  // namespace palpate
