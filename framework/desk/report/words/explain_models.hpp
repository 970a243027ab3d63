// SPDX-License-Identifier: MIT
// The models behind a choice, in words: for explain_tap().
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_record.hpp"
#include "record/row.hpp"
#include "report/words/words.hpp"

namespace palpate {

/// What the maps say of the place of the tap: u, and w and e or the probability of `footprint`, whichever the record of
/// the tap has.
void explain_place(Page& page, const Row& row, const std::string& footprint);

/// A paragraph for each process that the record of the tap has: hyperparameters and their fit, likelihood, condition,
/// engine, jitter, and how far its map goes. `now` is the choice as computed now, which knows the units of kernels.
void explain_models(Page& page, const Row& row, const ExperimentOptions& options, const TapRecord& now);

}  // namespace palpate
