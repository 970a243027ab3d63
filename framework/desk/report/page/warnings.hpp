// SPDX-License-Identifier: MIT
// What somebody who looks at a run should know before believing it, in plain words.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// One sentence or two each, the gravest first; empty for a run without trouble.
std::vector<std::string> warnings_of(const Recording& recording, const History& history);

}  // namespace palpate
