// SPDX-License-Identifier: MIT
// The page that compares several runs. These functions make its data, and web/runs.js draws it.
#pragma once

#include "report/history.hpp"

#include <string>
#include <vector>

namespace palpate {

/// Largest number of runs on a page. More runs would not have distinct colours.
inline constexpr std::size_t kMostRunsOnAPage = 8;

/// A run and its history.
struct ComparedRun {
  RecordedRun recording;
  History history;
};

/// Returns a page of 2 to kMostRunsOnAPage runs. It shows errors over taps and over robot time, surfaces after a number
/// of taps, and differences between the configs. For runs with the same candidates as the first run, it also shows the
/// differences from the first surface. Maps are left out until the page has at most kMostPageBytes. `progress` is
/// called while maps are packed.
std::string runs_page(const std::vector<ComparedRun>& runs, const OnProgress& progress);

}  // namespace palpate
