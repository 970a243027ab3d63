// SPDX-License-Identifier: MIT
// Positions of the first taps, if their number is fixed. The design `search` is in search_design.hpp.
#pragma once

#include "experiment/experiment_options.hpp"
#include "gp/candidate_grid.hpp"

#include <cstdint>
#include <vector>

namespace palpate {

/// Returns the indices of the candidates of the first taps for a design with a fixed count. All indices are different.
/// The result depends only on the design, the candidates and the seed, so strategies with equal seeds begin with the
/// same taps. There must be at least as many candidates as initial taps.
std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed);

}  // namespace palpate
