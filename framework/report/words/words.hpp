// SPDX-License-Identifier: MIT
// Numbers in sentences, and texts in sections for terminals.
#pragma once

#include "experiment/experiment.hpp"
#include "record/row.hpp"

#include <string>
#include <string_view>

namespace palpate {

/// Returns a number with at most four digits: "0.3848", "-1.2e-05".
std::string plain_words(double value);

/// Returns a length in a suitable unit with at most four digits: "0.1 mm", "9.07 cm", "1.2 m", "0 cm".
std::string length_words(double metres);

/// Returns an error with at most three digits: "2.61 mm".
std::string error_words(double metres);

/// Returns a time in the format of the table that `palpate run` prints: "2.0 s".
std::string seconds_words(double seconds);

/// Returns a position as "x 12.97 cm, y 7.59 cm", in the format of the table that `palpate run` prints.
std::string place_words(double x, double y);
/// Returns a height or another coordinate in the same format: "3.00 cm".
std::string place_words(double coordinate);

/// Returns the number in a field of a row, formatted by `words`. Returns "" if there is no number.
std::string number_words(const Row& row, std::string_view field, std::string (*words)(double) = plain_words);

/// Returns the numbers in the fields whose names begin with `prefix`. The names in the result lack the prefix.
Row numbers_below(const Row& row, const std::string& prefix);

/// Returns the probability of a suspected outlier, with the reason: "97 %, by its height, which does not fit the
/// heights of the other taps".
std::string doubt_words(const TapReading& one);

/// Returns a sentence, without its full stop, about a run whose truth is no longer known (RunReplay::truth_lost()).
std::string truth_lost_words(const Error& lost);

/// Returns "1 tap", "3 taps".
std::string counted(long count, const std::string& noun);

/// Text in sections for terminals. A section has a heading and items below it, in lines of at most 100 characters.
class TextSections {
 public:
  void heading(const std::string& text);
  /// Adds an item of one or two sentences. Control characters are replaced by blanks.
  void add(const std::string& text);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace palpate
