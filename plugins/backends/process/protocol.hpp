// SPDX-License-Identifier: MIT
// What is said to the program and what its answers mean: one JSON object a line. framework/docs/robots.md has the
// fields as a table.
#pragma once

#include "answers/answer.hpp"
#include "tapping/motion.hpp"

#include <palpate/plugin.hpp>

#include <string>

namespace palpate::process {

/// Rises when an ask or an answer changes its meaning; every ask carries it.
constexpr int kProtocol = 1;

/// The line that asks for a tap, with its line end. All that a program needs is in it, so that it may keep no state.
/// SI units.
std::string ask_line(const TapRequest& request, const Context& context, tapping::MotionOptions& motion);

/// What a line means as the answer to a tap.
struct Answer {
  bool in_step = false;   ///< it carries the number of the tap: the program and we speak of the same one
  bool accepted = false;  ///< and all of it is valid: `contact` is what the program says, else a failed tap
  /// Ends the run if the program says so, even in an answer that is refused.
  Contact contact;
};
/// Reads a line as the answer to this tap. A value that find_fault() finds is refused.
Answer read_answer(const std::string& line, int tap, const HeightBounds& bounds);

}  // namespace palpate::process
