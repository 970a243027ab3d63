// SPDX-License-Identifier: MIT
// The files that a page is made of, embedded in the program, so that a report needs neither an installation nor a
// network: plotly.js as vendored, the style, and the scripts of web/.
#pragma once

#include <string_view>

namespace palpate {

/// plotly.min.js, compressed by gzip.
std::string_view plotly_asset();

std::string_view style_asset();

/// What all pages use: unpacking, text that stays text, colours.
std::string_view common_script();

std::string_view run_script();
std::string_view sweep_script();

}  // namespace palpate
