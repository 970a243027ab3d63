// SPDX-License-Identifier: MIT
#include "experiment/make_belief.hpp"

#include "experiment/height_map.hpp"
#include "space/solids_belief.hpp"

namespace palpate {

const char* belief_name(const ExperimentOptions& options) {
  return options.scene.touch == SceneOptions::Touch::any ? "solids" : "height_map";
}

std::unique_ptr<Belief> make_belief(const ExperimentOptions& options, const Context& context, PhaseClock& clock) {
  if (options.scene.touch == SceneOptions::Touch::any) return std::make_unique<SolidsBelief>(options, context, clock);
  return std::make_unique<HeightMap>(options, context, clock);
}

}  // namespace palpate
