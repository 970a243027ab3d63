// SPDX-License-Identifier: MIT
// Numbers in sentences, and texts in sections for terminals.
#pragma once

#include "experiment/experiment.hpp"
#include "record/row.hpp"

#include <string>
#include <string_view>

namespace palpate {

/// Returns at most four digits: "0.3848", "-1.2e-05".
std::string plain_words(double value);

/// Returns a length in a suitable unit with at most four digits: "0.1 mm", "9.07 cm", "1.2 m", "0 cm".
std::string length_words(double metres);

/// Returns an error with at most three digits: "2.61 mm".
std::string error_words(double metres);

/// Returns a time as in the table of a run: "2.0 s".
std::string seconds_words(double seconds);

/// Returns "x 12.97 cm, y 7.59 cm", as in the table of a run.
std::string place_words(double x, double y);
/// Returns a height or another coordinate: "3.00 cm".
std::string place_words(double coordinate);

/// Returns the number in a field of a row, formatted by `words`; "" if there is none.
std::string number_words(const Row& row, std::string_view field, std::string (*words)(double) = plain_words);

/// Returns the numbers whose fields begin with `prefix`, by their names without it.
Row numbers_below(const Row& row, const std::string& prefix);

/// Returns probability and reason of a suspected outlier: "97 %, by its height, which does not fit the heights of the
/// other taps".
std::string doubt_words(const TapReading& one);

/// Returns a sentence, without its full stop, for a run whose truth is no longer known (RunReplay::truth_lost()).
std::string truth_lost_words(const Error& lost);

/// Returns "1 tap", "3 taps".
std::string counted(long count, const std::string& noun);

/// Text in sections: headings, and items below them, in lines of at most 100 letters.
class TextSections {
 public:
  void heading(const std::string& text);
  /// Adds an item of one or two sentences. Control characters become blanks.
  void add(const std::string& text);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace palpate
