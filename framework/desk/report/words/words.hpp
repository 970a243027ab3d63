// SPDX-License-Identifier: MIT
// Numbers in sentences: lengths in the unit that suits them, and lines that fit a terminal.
#pragma once

#include "experiment/tap_belief.hpp"
#include "record/row.hpp"

#include <string>
#include <string_view>

namespace palpate {

/// Four digits at most: "0.3848", "-1.2e-05".
std::string plain_words(double value);

/// Metres in the unit that suits them: "0.1 mm", "9.07 cm", "1.2 m", "0 cm"; four digits at most.
std::string length_words(double metres);

/// An error in metres as people say it: "2.61 mm"; three digits at most.
std::string error_words(double metres);

/// A time as in the table of a run: "2.0 s".
std::string seconds_words(double seconds);

/// "x 12.97 cm, y 7.59 cm", as in the table of a run.
std::string place_words(double x, double y);
/// The height of one, or another coordinate: "3.00 cm".
std::string place_words(double coordinate);

/// The number at `field` of a record as `words` has it; "" where there is none.
std::string number_words(const Row& row, std::string_view field, std::string (*words)(double) = plain_words);

/// What is thought of a contact that may lie, and why: "97 %, by its height", "80 %, by where it is: outlines that
/// agree with the other taps have no object there".
std::string doubt_words(const SuspectedOutlier& one);

/// What is said once of a run whose truth is lost, see Playback::truth_lost(): a sentence without its full stop.
std::string truth_lost_words(const Error& lost);

/// "1 tap", "3 taps"
std::string counted(long count, const std::string& noun);

/// Text in sections: headings, and sentences below them, broken into lines of at most 100 letters.
class TextSections {
 public:
  void heading(const std::string& text);
  /// A sentence or two that begin on a line of their own; control characters become blanks.
  void add(const std::string& text);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace palpate
