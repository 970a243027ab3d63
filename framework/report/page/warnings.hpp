// SPDX-License-Identifier: MIT
// Warnings on the page of a run.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Returns one or two sentences per warning, the gravest first; empty for a run without trouble.
std::vector<std::string> warnings_of(const RecordedRun& recording, const History& history);

}  // namespace palpate
