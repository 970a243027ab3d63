// SPDX-License-Identifier: MIT
// The page of a run. These functions make its data, and web/run.js draws it.
#pragma once

#include "record/field.hpp"
#include "report/history.hpp"
#include "report/page/json.hpp"

#include <string>

namespace palpate {

/// Largest size of a page in bytes. Pages of this size can be sent by mail. If the page of a run with all maps is
/// larger, it has maps of every second, third, fourth, sixth, ... moment only, and a note about this.
inline constexpr std::size_t kMostPageBytes = 4'000'000;

/// Returns the page of a run. `progress` is also called while maps are packed, because packing the maps takes as long
/// as computing them.
std::string run_page(const RecordedRun& recording, const History& history, const OnProgress& progress);

/// Returns the page of a run that is not finished, for a server. The page requests the moments after those of `history`
/// from its server. `history` has as many taps as `recording`. `at` is the position in the record up to which the page
/// has data; the page sends it with its requests.
std::string live_run_page(const RecordedRun& recording, const History& history, const std::string& at);

/// Returns the page of a run that has nothing to show yet. `why` is the reason in words. The page sends requests to its
/// server, as the page of live_run_page() does.
std::string waiting_page(const std::string& name, const std::string& id, const std::string& why, const std::string& at);

/// Returns an update for a page that has the first `moments` moments: JSON on one line with the other moments, their
/// maps, and all data that a tap may change. `history` has maps of these other moments only. `at` is the position in
/// the record up to which the page has data after the update.
std::string run_news(const RecordedRun& recording, const History& history, int moments, const std::string& at);

/// Maps in a compact form: differences of 16-bit numbers between neighbouring cells, with the low bytes separate from
/// the high bytes. This form compresses best, because neighbouring cells of smooth maps differ little.
struct PackedMaps {
  double least = 0.0;
  double most = 0.0;
  std::string bytes;
};

/// Packs frames. All frames must have the same number of cells and only finite values. Each cell becomes an integer
/// from 0 (the least value of all frames) to 65535 (the greatest). The error is at most 1 / 131070 of this range. Each
/// frame is stored as differences between neighbouring cells modulo 65536: first all low bytes, then all high bytes.
PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames);

/// Returns the errors that pages show: the errors against the truth, and the expected error.
std::vector<RecordField> page_errors();

/// Returns the data of a run's page without maps and surfaces.
Json run_data(const RecordedRun& recording, const History& history);

/// Adds the maps or surfaces of every `stride`-th shown moment to `data`, counted backwards from the last moment.
/// Returns the packed bytes of the maps. If `only` is not empty, adds only the map with that name.
std::string add_maps(Json& data, const History& history, std::size_t stride, std::string_view only = "");

}  // namespace palpate
