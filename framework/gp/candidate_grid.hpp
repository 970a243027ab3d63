// SPDX-License-Identifier: MIT
// Candidates of the next tap: the centres of a grid of cells over the area.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// Positions in a grid of `columns` x `rows`, stored row by row: index = row * columns + column. x increases with the
/// column, y with the row.
struct CandidateGrid {
  int columns = 0;
  int rows = 0;
  Points points;
  /// Coordinates of columns and rows: point i is at (xs(i % columns), ys(i / columns)). Empty if the positions are not
  /// a product grid.
  Eigen::VectorXd xs, ys;

  int size() const { return static_cast<int>(points.rows()); }
  bool is_grid() const { return xs.size() > 0; }
  Target target(int index) const { return {points(index, 0), points(index, 1)}; }

  /// Returns the candidate whose cell contains (x, y), or the nearest cell for a position outside the area.
  int nearest(double x, double y, const Area& area) const;
};

/// Returns the grid of fixed candidates.
CandidateGrid grid_of(const Candidates& candidates);

}  // namespace palpate
