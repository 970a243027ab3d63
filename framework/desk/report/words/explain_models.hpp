// SPDX-License-Identifier: MIT
// The models behind a choice, in words: for explain_tap().
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"
#include "report/words/evidence.hpp"
#include "report/words/words.hpp"

namespace palpate {

/// What the maps say of the place of the tap: u, and w and e or the probability of `footprint`, whichever there are.
void explain_place(Page& page, const Evidence& evidence, const std::string& footprint);

/// A paragraph for each process: hyperparameters and their fit, likelihood, condition, engine, what rounding asked
/// for, and how far its map goes. `now` is the choice as computed now, from `belief`, whose processes are all built.
void explain_models(Page& page, const Evidence& evidence, const ExperimentOptions& options, const TapBelief& belief,
                    const TapRecord& now);

}  // namespace palpate
