// SPDX-License-Identifier: MIT
// HTML pages in a single file with style, scripts, plotly and data. Data is compressed and never part of the markup, so
// texts of a config cannot act as HTML. The page's content security policy forbids network access. Only a page that
// `palpate watch` serves may send requests to its own server.
#pragma once

#include "report/page/json.hpp"

#include <string>
#include <string_view>
#include <vector>

/// The scripts of web/, which assets.S embeds in the program. A report therefore needs neither installed files nor a
/// network.
extern "C" const char palpate_asset_run[];
extern "C" const char palpate_asset_runs[];
extern "C" const char palpate_asset_sweep[];

namespace palpate {

/// Origin of a page: a file, or a server to which the page may send requests.
enum class PageOrigin { file, server };

/// Returns a page that runs the common script and then `script`. The scripts draw `data` and `maps`, the bytes of the
/// maps.
std::string make_page(std::string_view script, const Json& data, const std::string& maps,
                      PageOrigin of = PageOrigin::file);

/// Returns the unit in which pages show each column, as {unit, factor}: a value in SI times `factor` is in `unit`. The
/// units are those of config/display_units.hpp, and megabytes for sizes in bytes. Columns without a unit are left out.
Json display_units(const std::vector<std::string>& columns);

/// Returns the data as JSON on one line.
std::string line_of(const Json& data);

/// Returns `bytes` compressed by zlib (RFC 1950), which browsers call "deflate"; equal input gives equal output.
std::string deflated(std::string_view bytes);

std::string base64(std::string_view bytes);

}  // namespace palpate
