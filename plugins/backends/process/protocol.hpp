// SPDX-License-Identifier: MIT
// Requests and answers of the backend `process`. Each is one JSON object on one line. The table of fields is in
// framework/docs/robots.md.
#pragma once

#include "answers/tap_result_checks.hpp"
#include "tapping/motion.hpp"

#include <palpate/belief.hpp>
#include <palpate/plugin.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate::process {

/// Version of the protocol, which is part of every request. It increases if the meaning of a request or an answer
/// changes.
enum class ProtocolVersion { from_above = 1, any_line = 2 };

/// Returns the request for a tap, with its line end, in SI units. The request contains everything about the tap, so the
/// program needs no state.
std::string ask_line(const TapRequest& request, const Context& context, tapping::MotionOptions& motion,
                     ProtocolVersion protocol);

/// Result of reading a line as the answer to a tap.
struct Answer {
  bool in_step = false;   ///< whether the line has the number of this tap
  bool accepted = false;  ///< whether all fields are valid; otherwise `result` is a failed tap
  /// The field `ends_run` is set if the program requested the end of the run, even in a rejected answer.
  TapResult result;
};
/// Reads `line` as the answer to `request`. Answers with values for which find_fault() returns a fault are rejected.
Answer read_answer(const std::string& line, const TapRequest& request, const HeightBounds& bounds,
                   ProtocolVersion protocol);

/// Returns the request that asks along which lines the program can tap, with its line end. The request contains at most
/// `count` of `lines`, beginning with line `first`.
std::string reaches_line(const Candidates& lines, Eigen::Index first, Eigen::Index count, const Context& context);

/// Reads `line` as the answer to the request of reaches_line(). Returns one truth value per line, or an empty list if
/// the program reaches all lines. Returns nullopt for any other answer.
std::optional<std::vector<bool>> read_reaches(const std::string& line, Eigen::Index count);

}  // namespace palpate::process
