// SPDX-License-Identifier: MIT
// The moves of the Markov chain over outlines: what an outline is changed into, and how often that is to be taken.
#pragma once

#include "outline.hpp"
#include "push.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <vector>

namespace palpate::footprints {

/// An outline, where it was before, and how probable that is by the prior of the outline, up to a factor.
struct State {
  Outline outline;
  double density = 0.0;
  Push push;
};

/// A change, and what Metropolis and Hastings multiply the ratio of the likelihoods by: its prior density times the
/// density of proposing the way back, over those of what it was and of the way there. 0 where there is no way.
struct Proposal : State {
  double correction = 0.0;
};

/// Shifts, turns or stretches a piece, moves one of its sides, changes its family; adds a second piece or takes it away
/// again, or draws an outline anew. A second piece is added where the prior would have it or, one time in two, about a
/// label that the outline has wrong, because there it may set one right.
Proposal propose(const State& from, const OutlinePrior& prior, const std::vector<Touch>& touches, Random& random);

/// Adds a push or takes it away, or changes it. Either the outline stays where it is now, or where it was before: then
/// what was touched before agrees with it as well as it did. `rate`: the prior probability of a push between two of
/// the `touches`, at least 2.
Proposal propose_push(const State& from, const OutlinePrior& prior, int touches, double rate, Random& random);

}  // namespace palpate::footprints
