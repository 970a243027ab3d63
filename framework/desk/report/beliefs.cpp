// SPDX-License-Identifier: MIT
#include "report/beliefs.hpp"

namespace palpate {

bool is_any_side(const RecordedRun& recording) {
  return !recording.taps.empty() && !recording.taps.front().request.line.from_above;
}

ReadPlan page_readers(const RecordedRun& recording) {
  using namespace quantity;
  if (is_any_side(recording)) return readers_from_first_tap("page", {});
  return readers_from_first_tap("page", {kUncertainty, kMeasurementStd, kObjectProbability, kHeightMean, kHeightStd});
}

HeightMap& height_map_of(Experiment& experiment) { return dynamic_cast<HeightMap&>(experiment.belief()); }
SolidsBelief& solids_of(Experiment& experiment) { return dynamic_cast<SolidsBelief&>(experiment.belief()); }

bool is_footprint_weight(const HeightMap& belief) { return belief.models().footprint() == nullptr; }

std::vector<Ring> true_contours(Experiment& experiment) {
  constexpr double kApart = 0.01;
  constexpr double kOfGrid = 0.002;  // walls of 3 mm are whole
  const Scene* const truth = experiment.truth();
  if (truth == nullptr) return {};
  const Region& region = solids_of(experiment).region();
  return contours(*truth, region.centre, region.radius, kApart, kOfGrid);
}

}  // namespace palpate
