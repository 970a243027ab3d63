// SPDX-License-Identifier: MIT
// The page that compares several runs: its data, which web/runs.js draws.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Largest number of runs on a page, limited by distinct colours.
inline constexpr std::size_t kMostRunsOnAPage = 8;

/// A run and its history.
struct ComparedRun {
  RecordedRun recording;
  History history;
};

/// Returns a page of 2 to kMostRunsOnAPage runs: errors over taps and over robot time, surfaces after a number of taps,
/// differences from the first surface where the candidates are the same, and differences between the configs. It is at
/// most as large as the page of a run. `progress` is called while maps are packed.
std::string runs_page(const std::vector<ComparedRun>& runs, const OnProgress& progress);

}  // namespace palpate
