// SPDX-License-Identifier: MIT
// Pictures drawn by gnuplot. It runs in a child process and reads its script from an unnamed temporary file.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Returns `text` as a string literal of gnuplot. Nothing in the literal acts as a command, macro or format.
std::string gnuplot_text(const std::string& text);

/// Returns the text of a template in figure_templates.gnuplot.
std::string_view template_text(std::string_view name);

/// Returns a template with its placeholders replaced by the arguments.
template <class... Arguments>
std::string fill_template(std::string_view name, const Arguments&... arguments) {
  return fmt::format(fmt::runtime(template_text(name)), arguments...);
}

/// Unit of the lengths in a picture's layout.
enum class PictureUnit {
  pixel,  ///< pixels of a PNG or SVG on screens; points in a PDF
  point,  ///< 1/72 inch in a PDF or SVG for print, with fonts in points; a PNG has kPrintDpi pixels per inch
};

/// Pixels per inch of a PNG for print.
inline constexpr int kPrintDpi = 300;

/// Returns the first lines of a script, which set gnuplot's terminal and output. The extension of `file` (.png, .pdf or
/// .svg) determines the terminal, for a picture of `width` by `height` units. `output` is the file that gnuplot writes.
/// For print, the lines also define gnuplot's variable `mark_size`, the size of marks that suits letters of 8 points.
std::string picture_header(int width, int height, const std::filesystem::path& file, const std::string& output,
                           PictureUnit unit = PictureUnit::pixel);

/// Draws `script`, which must not set terminal and output, and renames the picture to `file`. The extension of `file`
/// determines the format, as in picture_header(). Returns "" after success, else one line with the reason of the
/// failure.
std::string draw_picture(const std::string& script, int width, int height, const std::filesystem::path& file,
                         PictureUnit unit = PictureUnit::pixel);

}  // namespace palpate
