// SPDX-License-Identifier: MIT
// Requests for taps from above.
#pragma once

#include <palpate/tap.hpp>

namespace palpate::test {

/// Returns a request for a tap from above.
inline TapRequest request_at(const Target& target, int number = 1) {
  TapRequest out;
  out.number = number;
  out.line = line_from_above(target);
  return out;
}

}  // namespace palpate::test
