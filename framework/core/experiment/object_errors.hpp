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

#include "experiment/metrics.hpp"

#include <optional>
#include <vector>

namespace palpate {

/// Of one object.
struct ObjectErrors {
  int cells = 0;
  bool merged = false;  ///< with another, whichever
  bool split = false;
  /// Its cells that are predicted, over its cells and those that are predicted for nothing: on no object, and nearer to
  /// a cell of this one than to any of another. So what is predicted too much counts once, and a cell of another object
  /// never. Absent if it has no cell, as under a larger object, or nobody asked for the probability.
  std::optional<double> iou;
  std::optional<double> rmse_height;  ///< metres, the height mean over its cells; likewise
};

/// One for each object of the scene.
std::vector<ObjectErrors> object_errors(const SurfaceMaps& maps, const Truth& truth, const Candidates& candidates);

}  // namespace palpate
