// SPDX-License-Identifier: MIT
// How well each of several objects is known, over the candidate cells, where the truth is known.
//
// A cell is of the object that is highest there, if it is of any; it is predicted where the footprint's probability is
// at least 1/2. Predicted cells form components, each of cells that share a side. A component holds an object if it has
// at least a fifth of the object's cells.
//
// Two objects are merged if one component holds both, though their own cells do not touch, not even at a corner: there
// is a gap to be seen. An object is split if two components or more hold it, though its own cells are one component.
#pragma once

#include "belief/metrics.hpp"

#include <optional>
#include <vector>

namespace palpate {

/// One for each object of the scene.
std::vector<ObjectErrors> object_errors(const SurfaceMaps& maps, const Truth& truth, const CandidateGrid& candidates);

}  // namespace palpate
