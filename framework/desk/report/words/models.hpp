// SPDX-License-Identifier: MIT
// The models of a recorded choice in words.
#pragma once

#include "experiment/height_models.hpp"
#include "report/words/words.hpp"

namespace palpate {

/// Adds a paragraph per GP in the record of the tap: hyperparameters with their fit, likelihood, condition, engine,
/// jitter, and range of its map. `now` are the models of that moment, which know the units of kernel parameters.
void explain_models(TextSections& sections, const Row& row, const ExperimentOptions& options, const HeightModels& now);

}  // namespace palpate
