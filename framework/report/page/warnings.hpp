// SPDX-License-Identifier: MIT
// Warnings on the page of a run.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns one or two sentences per warning, with the most serious warning first. Returns an empty list for a run
/// without problems.
std::vector<std::string> warnings_of(const RecordedRun& recording, const History& history);

}  // namespace palpate
