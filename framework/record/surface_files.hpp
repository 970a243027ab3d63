// SPDX-License-Identifier: MIT
// The files with the surface and the maps of a run.
#pragma once

#include "experiment/experiment.hpp"

#include <string>
#include <utility>

namespace palpate {

/// Returns name and content of the file of the reconstructed surface. Call this in Stage::summary. For a height map,
/// the file is surface.csv with one row per candidate: position, mean and standard deviation of the height, object
/// probability, reconstructed height, true height. For a mesh, the file is surface.ply.
std::pair<std::string, std::string> surface_file(Experiment& experiment);

/// Returns the true heights at fixed candidates, in metres.
Eigen::VectorXd true_heights(const Candidates& candidates, const Scene& scene);

/// Returns the current arrays of the belief as CSV; "" if there are none, or if the candidates are not fixed.
std::string maps_csv(Belief& belief, const BeliefState& state);

}  // namespace palpate
