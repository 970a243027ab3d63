// SPDX-License-Identifier: MIT
// The shipped beliefs of recorded runs, for reports that show more than quantities.
#pragma once

#include "experiment/height_map.hpp"
#include "record/run_replay.hpp"
#include "space/contours.hpp"
#include "space/solids_belief.hpp"

#include <vector>

namespace palpate {

/// Whether the taps of a run come from any side.
bool is_any_side(const RecordedRun& recording);

/// Returns the readers of a page: all that it shows, from the first tap on.
ReadPlan page_readers(const RecordedRun& recording);

/// Return the belief of an experiment, which is of that kind.
HeightMap& height_map_of(Experiment& experiment);
SolidsBelief& solids_of(Experiment& experiment);

/// Whether the footprint is the label GP, clipped, so that reports show w instead of p.
bool is_footprint_weight(const HeightMap& belief);

/// Returns contours of the true scene as it stands now, 1 cm apart; empty if the truth is not known.
std::vector<Ring> true_contours(Experiment& experiment);

}  // namespace palpate
