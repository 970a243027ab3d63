// SPDX-License-Identifier: MIT
// What the record of a tap says of the models that it was chosen from, in words.
#pragma once

#include "experiment/from_above.hpp"
#include "report/words/words.hpp"

namespace palpate {

/// A paragraph for each process that the record of the tap has: hyperparameters and their fit, likelihood, condition,
/// engine, jitter, and how far its map goes. `now` is the choice as computed now, which knows the units of kernels.
void explain_models(TextSections& page, const Row& row, const ExperimentOptions& options, const TapRecord& now);

}  // namespace palpate
