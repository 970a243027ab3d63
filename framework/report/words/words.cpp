// SPDX-License-Identifier: MIT
#include "report/words/words.hpp"

#include "analysis/mean_output.hpp"
#include "config/display_units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace palpate {

std::string plain_words(double value) { return significant(value, 4); }

std::string length_words(double metres) { return readable(metres, Unit::metre, 4, LengthKind::place); }

std::string error_words(double metres) { return readable(metres, Unit::metre, 3, LengthKind::error); }

std::string truth_lost_words(const Error& lost) {
  return fmt::format("The truth is no longer known, so the errors are those of the record: {}", lost.what());
}

std::string seconds_words(double seconds) { return usual_scale(Unit::second).quantity(seconds); }

std::string place_words(double coordinate) { return usual_scale(Unit::metre, LengthKind::place).quantity(coordinate); }

std::string place_words(double x, double y) { return fmt::format("x {}, y {}", place_words(x), place_words(y)); }

std::string number_words(const Row& row, std::string_view field, std::string (*words)(double)) {
  const std::optional<double> value = row.number(field);
  return value ? words(*value) : std::string();
}

Row numbers_below(const Row& row, const std::string& prefix) {
  Row out;
  for (const auto& field : row.fields) {
    if (field.first.compare(0, prefix.size(), prefix) != 0) continue;
    if (const auto number = row.number(field.first)) out.add(field.first.substr(prefix.size()), *number);
  }
  return out;
}

std::string doubt_words(const TapReading& one) {
  const char* const why = 2.0 * one.wrong_label_probability > one.outlier_probability
                              ? "by its position: outlines that fit the other taps have no object there"
                              : "by its height, which does not fit the heights of the other taps";
  return fmt::format("{:.0f} %, {}", 100.0 * one.outlier_probability, why);
}

std::string counted(long count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void TextSections::heading(const std::string& text) {
  if (!text_.empty()) text_ += "\n";
  text_ += one_line(text) + "\n";
}

void TextSections::add(const std::string& text) {
  constexpr std::size_t kWidth = 96;  // characters per line, without the dash before an item
  text_ += fmt::format("  - {}\n", fmt::join(wrapped(one_line(text), kWidth), "\n    "));
}

}  // namespace palpate
