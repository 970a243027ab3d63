// SPDX-License-Identifier: MIT
// Pictures by gnuplot, which runs as a process of its own and reads its script from a file that has no name.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// `text` as gnuplot's literal: nothing in it is a command, a macro or a format.
std::string gnuplot_text(const std::string& text);

/// What the lengths of a picture's layout are.
enum class PictureUnit {
  pixel,  ///< for a screen: of a PNG and an SVG; in a PDF points
  point,  ///< for print: 1/72 inch in a PDF and an SVG, fonts in points; a PNG has kPrintDpi
};

/// Pixels per inch of a PNG for print.
inline constexpr int kPrintDpi = 300;

/// Returns the first lines of a script: its terminal, by the extension of `file`, which is .png, .pdf or .svg, for a
/// picture of `width` by `height` units; and `output`, the file that gnuplot writes. For print the variable `mark_size`
/// has a size of marks that suits letters of 8 points.
std::string picture_header(int width, int height, const std::filesystem::path& file, const std::string& output,
                           PictureUnit unit = PictureUnit::pixel);

/// Draws `script` (without terminal and output) and renames the picture to `file`, by whose extension it is a PNG, PDF
/// or SVG: see picture_header(). Returns "", or in one line why there is no picture.
std::string draw_picture(const std::string& script, int width, int height, const std::filesystem::path& file,
                         PictureUnit unit = PictureUnit::pixel);

}  // namespace palpate
