// SPDX-License-Identifier: MIT
// Factorisations in the state of a belief.
#pragma once

#include "regular/regular_factor.hpp"

#include <palpate/record_fields.hpp>

#include <algorithm>

namespace palpate {

/// Adds the trouble of one model's factorisations; jitter in the square of its unit. Models have the same taps, so a
/// tap that several leave out counts once.
inline void count_factors(BeliefState& state, const FactorReport& factors) {
  state.jitter_max = std::max(state.jitter_max, factors.jitter);
  state.diagnostics["jitter"] += factors.raised;
  state.diagnostics["pivoted"] += factors.pivoted;
  int& redundant_taps = state.diagnostics["redundant_taps"];
  redundant_taps = std::max(redundant_taps, factors.redundant_taps);
}

}  // namespace palpate
