// SPDX-License-Identifier: MIT
#include "report/exchange/surface_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// How fast the heights fall along one axis, at position `at` of `count`, whose neighbours are `step` apart.
double fall(const VectorView& heights, const Eigen::VectorXd& places, int index, int at, int count, int step) {
  const int before = std::max(at - 1, 0);
  const int behind = std::min(at + 1, count - 1);
  if (before == behind) return 0.0;
  return (heights(index + (before - at) * step) - heights(index + (behind - at) * step)) /
         (places(behind) - places(before));
}

}  // namespace

// Views go by value, as in the interfaces. NOLINTNEXTLINE(performance-unnecessary-value-param)
SurfaceMesh surface_mesh(const Candidates& candidates, const VectorView& heights) {
  const int columns = candidates.columns;
  const int rows = candidates.rows;
  SurfaceMesh mesh;
  mesh.points.resize(candidates.size(), 3);
  mesh.points << candidates.points, heights;
  mesh.normals.resize(candidates.size(), 3);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int i = row * columns + column;
      mesh.normals.row(i) = Eigen::RowVector3d(fall(heights, candidates.xs, i, column, columns, 1),
                                               fall(heights, candidates.ys, i, row, rows, columns), 1.0)
                                .normalized();
    }
  }
  mesh.triangles.reserve(static_cast<std::size_t>(std::max(0, 2 * (columns - 1) * (rows - 1))));
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const int i = row * columns + column;
      mesh.triangles.push_back({i, i + 1, i + columns + 1});
      mesh.triangles.push_back({i, i + columns + 1, i + columns});
    }
  }
  return mesh;
}

}  // namespace palpate
