// SPDX-License-Identifier: MIT
// The report of a run as one page: web/run.js draws what is put together here.
#pragma once

#include "report/history.hpp"
#include "report/page/json.hpp"

#include <string>

namespace palpate {

/// A page is at most so large, so that it can be mailed. Where a run's maps would make it larger, only every second,
/// third, fifth, ... moment has maps; its page says so.
inline constexpr std::size_t kMostPageBytes = 4'000'000;

/// The page of a run: HTML, complete in itself. Packing the maps of a long run takes as long as computing them:
/// `progress` hears of it, too.
std::string run_page(const Recording& recording, const History& history, const OnProgress& progress);

/// The page of a run that goes on, to be served. It asks the server that it came from for what comes after the moments
/// of `history`, which has as many taps as `recording`, and says by `at` how far it is.
std::string live_run_page(const Recording& recording, const History& history, const std::string& at);

/// The page of a run of which there is nothing to be shown yet, `why` in words. It asks as live_run_page() does.
std::string waiting_page(const std::string& name, const std::string& id, const std::string& why, const std::string& at);

/// What a page takes that has the first `moments` moments: JSON on one line, of the rest of `history`, which has maps
/// of those moments alone, and of what may change with every tap. The page is then at `at`.
std::string run_news(const Recording& recording, const History& history, int moments, const std::string& at);

/// Maps in a few bytes a cell. Smooth maps have small steps from cell to cell: steps of 16-bit numbers, their low and
/// their high bytes apart, are what zlib makes least of.
struct PackedMaps {
  double least = 0.0;
  double most = 0.0;
  std::string bytes;
};

/// Packs frames of as many cells each, which are finite. A cell becomes a whole number from 0, for the least of all
/// frames, to 65535, for the most: it is off by at most 1 / 131070 of that range. Then, a frame at a time, the steps
/// from cell to cell modulo 65536, first all their low bytes and then all their high bytes.
PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames);

/// All that a page has of a run, but for its maps and surfaces.
Json run_data(const Recording& recording, const History& history);

/// Adds to `data` the maps, or surfaces, of every `stride`-th of the moments that are shown, counted from the last.
/// Returns the bytes of the maps. With `only`, the map of that name alone.
std::string add_maps(Json& data, const History& history, std::size_t stride, std::string_view only = "");

}  // namespace palpate
