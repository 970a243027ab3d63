// SPDX-License-Identifier: MIT
// The page of a run: its data, which web/run.js draws.
#pragma once

#include "record/field.hpp"
#include "report/history.hpp"
#include "report/page/json.hpp"

#include <string>

namespace palpate {

/// Largest size of a page, bytes, so that it can be mailed. A run whose maps exceed it has maps at every second, third,
/// fifth, ... moment, and a note on the page.
inline constexpr std::size_t kMostPageBytes = 4'000'000;

/// Returns the page of a run. `progress` is also called while maps are packed, which takes as long as computing them.
std::string run_page(const RecordedRun& recording, const History& history, const OnProgress& progress);

/// Returns the page of a run that goes on, for a server. The page asks its server for the moments after those of
/// `history`, which has as many taps as `recording`. `at` is the position in the record that the page reports.
std::string live_run_page(const RecordedRun& recording, const History& history, const std::string& at);

/// Returns the page of a run without anything to show yet; `why` is the reason in words. The page asks its server as
/// that of live_run_page() does.
std::string waiting_page(const std::string& name, const std::string& id, const std::string& why, const std::string& at);

/// Returns an update for a page with the first `moments` moments: JSON on one line with the other moments, their maps,
/// and all data that may change with a tap. `history` has maps of these moments alone. After the update the page is at
/// position `at`.
std::string run_news(const RecordedRun& recording, const History& history, int moments, const std::string& at);

/// Maps in a compact form. Differences of 16-bit numbers between neighbouring cells, with low and high bytes apart,
/// compress best: smooth maps have small differences.
struct PackedMaps {
  double least = 0.0;
  double most = 0.0;
  std::string bytes;
};

/// Packs frames with the same number of finite cells. A cell becomes an integer from 0, the least value of all frames,
/// to 65535, the greatest, with an error of at most 1 / 131070 of that range. Each frame is stored as differences
/// between neighbouring cells modulo 65536: first all low bytes, then all high bytes.
PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames);

/// Returns the errors that pages show: those against the truth, and the expected error.
std::vector<RecordField> page_errors();

/// Returns the data of a run's page without maps and surfaces.
Json run_data(const RecordedRun& recording, const History& history);

/// Adds the maps or surfaces of every `stride`-th shown moment, counted from the last, to `data`. Returns the bytes of
/// the maps. `only` selects the map with that name.
std::string add_maps(Json& data, const History& history, std::size_t stride, std::string_view only = "");

}  // namespace palpate
