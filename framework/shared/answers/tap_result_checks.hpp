// SPDX-License-Identifier: MIT
// Checks tap results that come from outside of palpate: from the program of the backend `process`, from tell() in
// Python, and from the table of the backend `replay`.
#pragma once

#include <palpate/tap.hpp>

#include <optional>
#include <string>

namespace palpate {

/// Range of the heights that an arm can measure, metres, in the frame of the scene.
struct HeightBounds {
  double lowest;
  double highest;
  const char* meaning;  ///< description of both bounds for messages
};

/// Bounds if arm and motion are unknown.
constexpr HeightBounds kAnyArm{-10.0, 10.0, "no arm is that long"};

/// Returns the bounds for a tap from above. The tool travels at the height `desk` + `hover` and descends at most to
/// `desk` - `overrun`, metres. The lower bound is 1 cm below the end of the descent, because an arm's height has
/// errors. The upper bound is the height of travel, because the arm would have hit a higher object on its way.
HeightBounds height_bounds(double desk, double overrun, double hover);

/// The two parts of a one-line message about a value that no arm can measure.
struct AnswerFault {
  std::string reason;
  std::string remedy;
};

/// Completes an answer that has only the touched point or only the distance along `line`, by computing the missing one
/// of these two values. On a line from above, the result has a point on this line and no distance.
void complete_contact(const TapLine& line, TapResult& answer);

/// Returns a message about the first value of an answer that is out of its bounds or not finite; nullopt if there is
/// none. On a line from above, the height of a contact has to be within `bounds`. On other lines, the distance has to
/// be from 0 to the line's length, and each coordinate of the touched point from -10 to 10 m. Force and peak force have
/// to be from 0 to 1000 N, and the duration from 0 to 86400 s (one day).
std::optional<AnswerFault> find_fault(const TapResult& answer, const TapLine& line, const HeightBounds& bounds);

/// Returns the outcome with this name. Returns nullopt for other names, and for `unknown`, which means that there is no
/// answer.
std::optional<Outcome> answered_outcome(const std::string& name);

/// Returns `text` (UTF-8) as one line for records and terminals, cut between characters after about 200 bytes. Blanks
/// replace control characters, line separators and marks that change the direction of writing.
std::string plain_line(const std::string& text);

}  // namespace palpate
