// SPDX-License-Identifier: MIT
// Steps of a Markov chain over outlines.
#pragma once

#include "prior.hpp"

#include <palpate/footprint.hpp>

#include <vector>

namespace palpate::footprints {

/// A changed outline, and what Metropolis and Hastings multiply the ratio of the likelihoods by: its prior density
/// times the density of proposing the way back, over those of the outline as it was and of the way there. 0 where there
/// is no way.
struct Proposal {
  Outline outline;
  double density = 0.0;  ///< of it, by the prior
  double correction = 0.0;
};

/// Shifts, turns or stretches a piece, moves one of its sides, changes its family; adds a second piece or takes it away
/// again, or draws an outline anew. A second piece is added where the prior would have it or, one time in two, about a
/// label that the outline has wrong, because there it may set one right. `density` is that of `from`, by the prior.
Proposal propose(const Outline& from, double density, const OutlinePrior& prior, const std::vector<Touch>& touches,
                 Random& random);

}  // namespace palpate::footprints
