// SPDX-License-Identifier: MIT
// Explanation of a recorded tap in words.
#pragma once

#include "record/run_replay.hpp"

#include <string>

namespace palpate {

/// Returns about twenty lines about tap `tap` (counted from 1) of a recorded run: the reason for its choice, the models
/// at that time, the expected and the actual result, and the effect of the tap. Values that the record lacks, such as
/// the expected height, are computed again from the taps. Throws Error if there is no such tap.
std::string explain_tap(const RunEnvironment& environment, const RecordedRun& recording, int tap);

}  // namespace palpate
