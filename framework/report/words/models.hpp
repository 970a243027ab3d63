// SPDX-License-Identifier: MIT
// Texts about the models at the time when a recorded tap was chosen.
#pragma once

#include "belief/height_map_options.hpp"
#include "experiment/experiment_options.hpp"
#include "report/words/words.hpp"

#include <palpate/plugin.hpp>

namespace palpate {

/// Adds one paragraph per GP in the record of the tap: hyperparameters with their fit, likelihood, condition, engine,
/// jitter, and range of the map. `context` creates the kernels, which provide the units of their parameters.
void explain_models(TextSections& sections, const Row& row, const ExperimentOptions& options,
                    const HeightMapOptions& own, const Context& context);

}  // namespace palpate
