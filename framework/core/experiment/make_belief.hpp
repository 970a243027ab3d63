// SPDX-License-Identifier: MIT
// The choice of the belief by the config.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/phases.hpp"

#include <palpate/belief.hpp>
#include <palpate/plugin.hpp>

#include <memory>

namespace palpate {

/// Returns `solids` for taps from any side, else `height_map`.
const char* belief_name(const ExperimentOptions& options);

/// Returns the belief of that name. `context` and `clock` must outlive it. Defined in space/, which knows both beliefs.
std::unique_ptr<Belief> make_belief(const ExperimentOptions& options, const Context& context, PhaseClock& clock);

}  // namespace palpate
