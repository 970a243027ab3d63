// SPDX-License-Identifier: MIT
// A page that is one file: style, scripts, plotly and data in it, nothing to load. Data goes in as data, compressed: no
// text of a config is ever part of the markup, and the page's own policy forbids the browser to ask a network for
// anything; one that is served may ask the server that it came from (`palpate watch`).
#pragma once

#include "report/page/json.hpp"

#include <string>
#include <string_view>
#include <vector>

/// The scripts of web/, embedded in the program by assets.S, so that a report needs neither an installation nor a
/// network.
extern "C" const char palpate_asset_run[];
extern "C" const char palpate_asset_runs[];
extern "C" const char palpate_asset_sweep[];

namespace palpate {

/// Where a page lies: in a file, or with a server, which alone it may then ask for more.
enum class PageOf { file, server };

/// A page that runs `script` (behind the common one) on the data and on maps as bytes.
std::string make_page(std::string_view script, const Json& data, const std::string& maps, PageOf of = PageOf::file);

/// Returns for each of some columns of a record the unit in which pages show it, {unit, factor}: a value in SI times
/// `factor` is in `unit`, the usual unit of config/scale.hpp; megabytes for sizes in bytes. Columns that are shown in
/// SI without a unit are left out.
Json display_units(const std::vector<std::string>& columns);

/// Data on one line.
std::string line_of(const Json& data);

/// Compressed as zlib does (RFC 1950), which browsers call "deflate"; equal bytes for equal input.
std::string deflated(std::string_view bytes);

std::string base64(std::string_view bytes);

}  // namespace palpate
