// SPDX-License-Identifier: MIT
// Heights over the candidate grid as a triangle mesh.
#pragma once

#include "gp/candidates.hpp"

#include <array>
#include <vector>

namespace palpate {

/// A vertex a candidate, in the order of the candidates; two triangles for every four neighbours, none where the grid
/// is one candidate wide.
struct SurfaceMesh {
  using Triples = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  Triples points;   ///< x, y, z, metres, a vertex a row
  Triples normals;  ///< of length 1, upward
  /// Vertices of a triangle, counter-clockwise seen from above: its normal looks upward, as those of its vertices do.
  std::vector<std::array<int, 3>> triangles;
};

/// `heights` in metres, one for each of `candidates`, which are a grid. Normals are those of central differences of the
/// heights, one-sided at the edges; a direction with a single candidate is level.
SurfaceMesh surface_mesh(const Candidates& candidates, const VectorView& heights);

}  // namespace palpate
