// SPDX-License-Identifier: MIT
// Pictures by gnuplot, which runs as a process of its own and reads its script from a file that has no name.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// `text` as gnuplot's literal: nothing in it is a command, a macro or a format.
std::string gnuplot_text(const std::string& text);

/// The first lines of a script: its terminal, a PNG of `width` by `height` pixels, and `output`, its file.
std::string png_header(int width, int height, const std::string& output);

/// Draws `script` (without terminal and output) as a PNG of `width` by `height` pixels and renames it to `file`.
/// Returns "", or in one line why there is no picture.
std::string draw_png(const std::string& script, int width, int height, const std::filesystem::path& file);

}  // namespace palpate
