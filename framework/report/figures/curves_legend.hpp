// SPDX-License-Identifier: MIT
// The legend of a figure with curves, and the widths of its texts. All lengths are in points (1/72 inch).
#pragma once

#include "report/figures/figure_layout.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

inline constexpr double kLineHeight = 11;
inline constexpr double kEndRoom = 9;  ///< free width at the right edge of the figure

/// Style of the curve of a group. Dashes and marks distinguish the groups in grey prints.
struct LineStyle {
  std::string colour;
  std::string line;   ///< gnuplot's style of the line, with its colour
  std::string point;  ///< gnuplot's style of the mark
};

/// Returns the style of the curve with this index.
LineStyle line_style(std::size_t curve);

/// Returns an upper bound of the width of a line of text in DejaVu Sans with 8 points.
double width_of_line(const std::string& text);

/// Returns the text in lines of at most this width, broken after blanks where possible.
std::vector<std::string> lines_within(const std::string& text, double width);

/// The name of a group in the legend.
struct LegendEntry {
  double x = 0.0;
  std::size_t row = 0;
  std::vector<std::string> lines;
};

/// Places names side by side, beginning at `left`, in a figure with this width. A name that is wider than the figure is
/// broken into several rows, and these rows contain no other name.
std::vector<LegendEntry> place_names(const std::vector<std::string>& names, double left, double width);

/// Draws bands, lines, marks and names of the groups.
void draw_legend(FigureLayout& layout, const std::vector<LegendEntry>& entries);

}  // namespace palpate
