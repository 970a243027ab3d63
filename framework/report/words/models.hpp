// SPDX-License-Identifier: MIT
// The models of a recorded choice in words.
#pragma once

#include "experiment/experiment_options.hpp"
#include "report/words/words.hpp"

#include <palpate/plugin.hpp>

namespace palpate {

/// Adds a paragraph per GP in the record of the tap: hyperparameters with their fit, likelihood, condition, engine,
/// jitter, and range of its map. `context` creates kernels, which know the units of their parameters.
void explain_models(TextSections& sections, const Row& row, const ExperimentOptions& options,
                    const HeightMapOptions& own, const Context& context);

}  // namespace palpate
