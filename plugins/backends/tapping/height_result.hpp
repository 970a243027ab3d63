// SPDX-License-Identifier: MIT
// The result of a motion along one axis. The motion goes straight down or along another line. For another line, the
// remaining length of the line takes the place of the height.
#pragma once

#include <palpate/tap.hpp>

#include <optional>
#include <string>
#include <utility>

namespace palpate::tapping {

/// Result of a tap without its line: a height replaces the touched point of TapResult.
struct HeightResult {
  Outcome outcome = Outcome::unknown;
  double height = 0.0;   ///< height of the contact, metres; only for `contact`
  double force = 0.0;    ///< force at contact, newtons; only for `contact`
  double seconds = 0.0;  ///< robot time
  std::string reason{};
  bool ends_run = false;
  std::optional<double> peak_force = std::nullopt;  ///< newtons
};

/// Returns the result of a tap along `line`. The x and y of a contact are those of the start of `line`, which is right
/// for a line from above. For other lines, the caller sets x, y and the distance.
inline TapResult result_on(const TapLine& line, HeightResult result) {
  TapResult out = result.outcome == Outcome::contact ? contact_on(line, result.height, result.force, result.seconds)
                                                     : tap_without_contact(result.outcome, result.seconds);
  out.reason = std::move(result.reason);
  out.ends_run = result.ends_run;
  out.peak_force = result.peak_force;
  return out;
}

}  // namespace palpate::tapping
