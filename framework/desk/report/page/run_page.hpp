// SPDX-License-Identifier: MIT
// The report of a run as one page: web/run.js draws what is put together here.
#pragma once

#include "report/history.hpp"

#include <string>

namespace palpate {

/// A page is at most so large, so that it can be mailed. Where a run's maps would make it larger, only every second,
/// third, fifth, ... moment has maps; its page says so.
inline constexpr std::size_t kMostPageBytes = 2'900'000;

/// The page of a run: HTML, complete in itself. Packing the maps of a long run takes as long as computing them:
/// `progress` hears of it, too.
std::string run_page(const Recording& recording, const History& history, const OnProgress& progress);

}  // namespace palpate
