// SPDX-License-Identifier: MIT
// The report of several runs side by side as one page: web/runs.js draws what is put together here.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// More than these are no longer told apart by their colours.
inline constexpr std::size_t kMostRunsOnAPage = 8;

/// A run among others.
struct RunBeside {
  Recording recording;
  History history;
};

/// The page of 2 to kMostRunsOnAPage runs: their errors over taps and over robot time in one plot each, their surfaces
/// as they were after a number of taps, how each differs from the first where both have the same candidates, and what
/// differs in their configs. HTML, complete in itself, and as small as the page of a run. `progress` hears of the
/// packing.
std::string runs_page(const std::vector<RunBeside>& runs, const OnProgress& progress);

}  // namespace palpate
