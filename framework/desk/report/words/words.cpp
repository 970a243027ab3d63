// SPDX-License-Identifier: MIT
#include "report/words/words.hpp"

#include "analysis/readable.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace palpate {

std::string plain_words(double value) { return fmt::format("{:.6g}", value == 0.0 ? 0.0 : value); }

std::string length_words(double metres) {
  const double size = std::abs(metres);
  if (size == 0.0) return "0 cm";
  if (size < 0.00995) return fmt::format("{:.4g} mm", metres * 1e3);
  return size < 1.0 ? fmt::format("{:.4g} cm", metres * 1e2) : fmt::format("{:.4g} m", metres);
}

std::string place_words(double x, double y) { return fmt::format("x {:.2f} cm, y {:.2f} cm", x * 1e2, y * 1e2); }

std::string number_words(const Row& row, std::string_view field, std::string (*words)(double)) {
  const std::optional<double> value = row.number(field);
  return value ? words(*value) : std::string();
}

std::string doubt_words(const TapBelief::Doubted& one) {
  const char* const why = 2.0 * one.by_label > one.doubt
                              ? "by where it is: outlines that agree with the other taps have no object there"
                              : "by its height, which those of the other taps do not lead to";
  return fmt::format("{:.0f} %, {}", 100.0 * one.doubt, why);
}

std::string counted(long count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void Page::heading(const std::string& text) {
  if (!text_.empty()) text_ += "\n";
  text_ += one_line(text) + "\n";
}

void Page::say(const std::string& text) {
  constexpr std::size_t kWidth = 100;
  constexpr std::size_t kIndent = 3;
  std::string line = "  -";
  std::istringstream words(one_line(text));
  for (std::string word; words >> word;) {
    if (line.size() > kIndent && line.size() + 1 + word.size() > kWidth) {
      text_ += line + "\n";
      line = "   ";
    }
    line += " " + word;
  }
  text_ += line + "\n";
}

}  // namespace palpate
