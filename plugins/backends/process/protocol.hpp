// SPDX-License-Identifier: MIT
// Requests and answers of the backend `process`: one JSON object per line. The table of fields is in
// framework/docs/robots.md.
#pragma once

#include "answers/answer.hpp"
#include "tapping/motion.hpp"

#include <palpate/plugin.hpp>

#include <string>

namespace palpate::process {

/// Version of the protocol, in every request. It increases if the meaning of a request or an answer changes.
constexpr int kProtocol = 1;

/// Returns the request for a tap, with its line end, in SI units. It is complete, so that the program needs no state.
std::string ask_line(const TapRequest& request, const Context& context, tapping::MotionOptions& motion);

/// Result of reading a line as the answer to a tap.
struct Answer {
  bool in_step = false;   ///< whether the line has the number of the tap
  bool accepted = false;  ///< whether all fields are valid; if not, `result` is a failed tap
  /// `ends_run` is set if the program requested it, even in a rejected answer.
  TapResult result;
};
/// Reads `line` as the answer to `request`. Values that find_fault() reports are rejected.
Answer read_answer(const std::string& line, const TapRequest& request, const HeightBounds& bounds);

}  // namespace palpate::process
