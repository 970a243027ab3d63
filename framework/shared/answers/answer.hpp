// SPDX-License-Identifier: MIT
// Checks answers to taps that come from outside: from the program of the backend `process`, from tell() in Python, and
// from the table of the backend `replay`.
#pragma once

#include <palpate/types.hpp>

#include <optional>
#include <string>

namespace palpate {

/// The heights that an arm can have touched, metres, in the frame of the scene.
struct HeightBounds {
  double lowest;
  double highest;
  const char* meaning;  ///< of both, in a few words
};

/// The bounds where nothing is known of arm and motion.
constexpr HeightBounds kAnyArm{-10.0, 10.0, "no arm is that long"};

/// Returns the bounds for a tap from above that travels at `desk` + `hover` and ends at `desk` - `overrun`, all in
/// metres. They leave 1 cm below that floor for the error of an arm's height. Above the height of travel they leave
/// nothing: the arm would have hit the thing on its way.
HeightBounds height_bounds(double desk, double overrun, double hover);

/// A value that no arm can have measured: which, its bounds, and what to do about it. Both are parts of one line.
struct AnswerFault {
  std::string reason;
  std::string remedy;
};

/// Returns the first value of an answer that is out of its bounds or not a finite number, nullopt if there is none. The
/// height of a contact lies within `bounds`, force and peak within 0 to 1000 N, the seconds within 0 to 86400, a day.
std::optional<AnswerFault> find_fault(const Contact& answer, const HeightBounds& bounds);

/// Returns the outcome of this name. Returns nullopt for a name that no answer may have, and so for `unknown`, which
/// means that there was no answer.
std::optional<Outcome> answered_outcome(const std::string& name);

/// Returns `text` (UTF-8) as one line for records and terminals, at most about 200 bytes, cut between characters.
/// Control characters, line separators and marks that change the direction of writing become blanks.
std::string plain_line(const std::string& text);

}  // namespace palpate
