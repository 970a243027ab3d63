// SPDX-License-Identifier: MIT
#include "report/figures/curves_legend.hpp"

#include "analysis/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace palpate {
namespace {

constexpr double kSampleLength = 22;  ///< length of the line before a name
constexpr double kNameGap = 5;        ///< between line and name
constexpr double kBetweenNames = 16;

// Upper bounds of letter widths in DejaVu Sans by class of letters, in units of the font size.
constexpr double kFont = 8;
struct LetterClass {
  const char* letters;
  double width;
};
constexpr std::array<LetterClass, 3> kLetterClasses{
    {{"fijlrtI .,:;'|!()[]/-", 0.42}, {"mMWO@%", 1.0}, {"wGQ+=<>~ABCDHKNPRSTUVXYZ", 0.84}}};
constexpr double kOtherLetters = 0.65;

}  // namespace

LineStyle line_style(std::size_t curve) {
  constexpr std::array<const char*, 4> kDashes{"solid", "(7,2.5)", "(2,2)", "(8,2,2,2)"};
  // gnuplot's point types: disc, triangle, square, diamond, and the same four without filling
  constexpr std::array<int, 8> kMarks{7, 9, 5, 13, 6, 8, 4, 12};
  const std::string colour = kLineColours[curve % kLineColours.size()];
  // The ninth group has the first colour again, with another dash.
  return {
      colour,
      fmt::format("lw 1 dt {} lc rgb '{}'", kDashes[(curve + curve / kLineColours.size()) % kDashes.size()], colour),
      fmt::format("pt {} ps mark_size", kMarks[curve % kMarks.size()])};
}

double width_of_line(const std::string& text) {
  double out = 0.0;
  for (const char c : text) {
    const auto* const one = std::find_if(kLetterClasses.begin(), kLetterClasses.end(), [c](const LetterClass& letters) {
      return std::string_view(letters.letters).find(c) != std::string_view::npos;
    });
    out += kFont * (one != kLetterClasses.end() ? one->width : kOtherLetters);
  }
  return out;
}

std::vector<std::string> lines_within(const std::string& text, double width) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin + 1;
    while (end < text.size() && width_of_line(text.substr(begin, end + 1 - begin)) <= width) ++end;
    const std::size_t blank = text.rfind(' ', end);
    if (end < text.size() && blank != std::string::npos && blank > begin) end = blank + 1;
    // keeps UTF-8 sequences together
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
    out.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return out;
}

std::vector<LegendEntry> place_names(const std::vector<std::string>& names, double left, double width) {
  std::vector<LegendEntry> out;
  double x = left;
  std::size_t row = 0;
  for (const std::string& name : names) {
    std::vector<std::string> lines = lines_within(name, width - left - kSampleLength - kNameGap - kEndRoom);
    const double length = kSampleLength + kNameGap + width_of_line(lines.front());
    if (x > left && (lines.size() > 1 || x + length > width - kEndRoom)) {
      x = left;
      ++row;
    }
    out.push_back({x, row, lines});
    x += length + kBetweenNames;
    if (lines.size() > 1) {
      x = left;
      row += lines.size();
    }
  }
  return out;
}

void draw_legend(FigureLayout& layout, const std::vector<LegendEntry>& entries) {
  std::string settings = fill_template("frameless");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const LegendEntry& entry = entries[i];
    const LineStyle style = line_style(i);
    const double right = entry.x + kSampleLength;
    double y = 4 + kLineHeight * (static_cast<double>(entry.row) + 0.5);
    settings += fmt::format("set object rectangle from {} to {} fc rgb '{}' fs transparent solid 0.18 noborder\n",
                            layout.at(entry.x, y - 3.5), layout.at(right, y + 3.5), style.colour);
    settings +=
        fmt::format("set arrow from {} to {} nohead {}\n", layout.at(entry.x, y), layout.at(right, y), style.line);
    settings += layout.label("", 0.5 * (entry.x + right), y,
                             fmt::format("point {} lc rgb '{}' front", style.point, style.colour));
    for (const std::string& line : entry.lines) {
      settings += layout.label(line, right + kNameGap, y, "left");
      y += kLineHeight;
    }
  }
  layout.plot({0, 0, 10, 10}, settings, "plot NaN");
}

}  // namespace palpate
