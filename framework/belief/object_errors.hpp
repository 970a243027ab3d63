// SPDX-License-Identifier: MIT
// Errors of each object separately, over the candidate cells, compared with the true scene.
//
// A cell belongs to the highest object at its centre, if any. A cell is predicted if the footprint's probability there
// is at least 1/2. Predicted cells form components of cells that share a side. A component holds an object if it
// contains at least a fifth of the object's cells.
//
// Two objects count as merged if one component holds both objects, although their true cells do not touch, not even at
// a corner. The true objects then have a visible gap between them. An object counts as split if several components hold
// it, although its true cells form one component.
#pragma once

#include "belief/metrics.hpp"

#include <vector>

namespace palpate {

/// Returns the errors of each object of the scene.
std::vector<ObjectErrors> object_errors(const SurfaceMaps& maps, const Truth& truth, const CandidateGrid& candidates);

}  // namespace palpate
