// SPDX-License-Identifier: MIT
// Grids of candidates: those of a config, and those with columns and rows anywhere.
#pragma once

#include "gp/candidate_grid.hpp"

#include <palpate/grid.hpp>

#include <utility>

namespace palpate::test {

/// Returns the grid of a config with `candidates.count`.
inline CandidateGrid grid_by_count(const Area& area, int count) {
  RunSettings run;
  run.candidates = count;
  return grid_of(grid_from_above(area, 0.0, run));
}

/// Returns the grid of a config with `candidates.spacing`, metres.
inline CandidateGrid grid_by_spacing(const Area& area, double spacing) {
  RunSettings run;
  run.spacing = spacing;
  return grid_of(grid_from_above(area, 0.0, run));
}

/// Returns the positions (x, y) for all y of `ys` and, for each, all x of `xs`.
inline CandidateGrid product_grid(Eigen::VectorXd xs, Eigen::VectorXd ys) {
  const auto columns = static_cast<int>(xs.size());
  const auto rows = static_cast<int>(ys.size());
  CandidateGrid out{columns, rows, Points(columns * rows, 2), std::move(xs), std::move(ys)};
  for (int row = 0; row < rows; ++row) {
    out.points.col(0).segment(Eigen::Index{row} * columns, columns) = out.xs;
    out.points.col(1).segment(Eigen::Index{row} * columns, columns).setConstant(out.ys(row));
  }
  return out;
}

}  // namespace palpate::test
