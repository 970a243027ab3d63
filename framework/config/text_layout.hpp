// SPDX-License-Identifier: MIT
// Line wrapping and columns of text.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {

/// Splits `text` into lines of at most `width` characters, at blanks. A longer word gets its own line.
inline std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty() && lines.back().size() + 1 + word.size() <= width) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

/// Aligns the cells of lines as columns, two blanks apart. `sides` has one letter per column, l (left) or r (right).
/// Columns that are empty in all lines are omitted.
inline std::string aligned(const std::vector<std::vector<std::string>>& lines, const std::string& sides) {
  std::vector<std::size_t> widths(sides.size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string out;
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (widths[i] == 0) continue;
      const char* const cell = sides[i] == 'l' ? "{:<{}}  " : "{:>{}}  ";
      text += fmt::format(fmt::runtime(cell), line[i], widths[i]);
    }
    out += text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  return out;
}

}  // namespace palpate
