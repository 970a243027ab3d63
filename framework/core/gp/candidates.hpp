// SPDX-License-Identifier: MIT
// The places among which the next tap is chosen: the centres of a grid of cells over the area.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// columns x rows places, row by row: index = row * columns + column, x grows with the column, y with the row.
struct Candidates {
  int columns = 0;
  int rows = 0;
  Points points;
  /// Coordinates of the columns and of the rows: point i lies at (xs(i % columns), ys(i / columns)). Both empty for
  /// places that are no product grid.
  Eigen::VectorXd xs, ys;

  int size() const { return static_cast<int>(points.rows()); }
  bool is_grid() const { return xs.size() > 0; }
  Target target(int index) const { return {points(index, 0), points(index, 1)}; }

  /// The candidate whose cell holds (x, y); places outside the area belong to the nearest cell.
  int nearest(double x, double y, const Area& area) const;
};

/// More cells along a side than anyone can pay for; the callers of the grids see to it.
constexpr int kMaxCellsPerSide = 2000;

/// `count` cells along each side, 1 to kMaxCellsPerSide.
Candidates grid_by_count(const Area& area, int count);

/// Cells of about `spacing` metres: each side is cut into cells_along(side, spacing), at most kMaxCellsPerSide.
Candidates grid_by_spacing(const Area& area, double spacing);

/// The places (x, y) for all y of `ys` and, for each, all x of `xs`, in any order and at any distance.
Candidates product_grid(Eigen::VectorXd xs, Eigen::VectorXd ys);

/// round(side / spacing), at least one; real, because it may be beyond any integer.
double cells_along(double side, double spacing);

}  // namespace palpate
