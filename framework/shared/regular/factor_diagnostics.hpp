// SPDX-License-Identifier: MIT
// Adds the diagnostics of factorisations to the state of a belief.
#pragma once

#include "regular/regular_factor.hpp"

#include <palpate/record_fields.hpp>

#include <algorithm>

namespace palpate {

/// Adds the numerical diagnostics of one model to the state. The jitter is a variance, in the squared unit of the
/// model's values. All models have the same taps, so a redundant tap counts only once, even if several models leave it
/// out.
inline void count_factors(BeliefState& state, const FactorReport& factors) {
  state.jitter_max = std::max(state.jitter_max, factors.jitter);
  state.diagnostics["jitter"] += factors.raised;
  state.diagnostics["pivoted"] += factors.pivoted;
  int& redundant_taps = state.diagnostics["redundant_taps"];
  redundant_taps = std::max(redundant_taps, factors.redundant_taps);
}

}  // namespace palpate
