// SPDX-License-Identifier: MIT
// A fixed grid of taps from above, and errors of heights on it: for authors of beliefs.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/error.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate {

/// Largest number of cells along a side.
constexpr int kMaxCellsPerSide = 2000;

/// Returns lines straight down at the centres of a grid of cells over the area, row by row: x increases with the
/// column, y with the row. The lines begin above every object and end below the desk, whose height is `desk` (metres);
/// the arm may join them at any height. `run` sets the number or the size of the cells; by default, there are
/// `usual_count` cells per side. Throws Error for more than kMaxCellsPerSide.
inline Candidates grid_from_above(const Area& area, double desk, const RunSettings& run, int usual_count = 47) {
  constexpr double kTop = 0.5;      // metres above the desk
  constexpr double kBeneath = 0.1;  // metres below the desk
  const auto cells = [&](double side) {
    const double count =
        run.spacing ? std::round(side / *run.spacing) : static_cast<double>(run.candidates.value_or(usual_count));
    if (count > kMaxCellsPerSide)
      throw Error(run.spacing ? "candidates.spacing" : "candidates.count",
                  "cuts the area into more than " + std::to_string(kMaxCellsPerSide) + " cells along a side",
                  "use larger cells");
    return std::max(1, static_cast<int>(count));
  };
  Candidates out;
  out.columns = cells(area.width);
  out.rows = cells(area.depth);
  out.from_above = true;
  out.starts.resize(Eigen::Index{out.rows} * out.columns, 3);
  for (Eigen::Index i = 0; i < out.starts.rows(); ++i) {
    const Eigen::Index row = i / out.columns;
    out.starts(i, 0) = (static_cast<double>(i % out.columns) + 0.5) * area.width / out.columns;
    out.starts(i, 1) = (static_cast<double>(row) + 0.5) * area.depth / out.rows;
  }
  out.starts.col(2).setConstant(desk + kTop);
  out.directions = Eigen::RowVector3d(0.0, 0.0, -1.0);
  out.lengths = Eigen::VectorXd::Constant(1, kTop + kBeneath);
  return out;
}

/// Returns such a grid for the area, the desk and the cells that the config sets.
inline Candidates grid_from_above(const Context& context, int usual_count = 47) {
  return grid_from_above(context.scene.area(), context.scene.desk(), context.run, usual_count);
}

/// Returns the errors of heights (M values, metres) at fixed candidates from above. `on_object`: cells predicted to be
/// on an object.
inline Errors height_errors(const Candidates& candidates, const Eigen::VectorXd& heights,
                            const Eigen::Array<bool, Eigen::Dynamic, 1>& on_object, const Scene& truth) {
  double squares = 0.0;
  double squares_object = 0.0;
  int true_cells = 0;
  int both = 0;
  int either = 0;
  for (Eigen::Index i = 0; i < candidates.size(); ++i) {
    const double height = truth.height(candidates.starts(i, 0), candidates.starts(i, 1));
    const double square = (heights(i) - height) * (heights(i) - height);
    const bool on = truth.on_object(height);
    squares += square;
    squares_object += on ? square : 0.0;
    true_cells += on ? 1 : 0;
    both += on && on_object(i) ? 1 : 0;
    either += on || on_object(i) ? 1 : 0;
  }
  Errors out;
  out.rmse = std::sqrt(squares / static_cast<double>(candidates.size()));
  if (true_cells > 0) out.rmse_height = out.rmse_object = std::sqrt(squares_object / true_cells);
  out.footprint_iou = either > 0 ? static_cast<double>(both) / either : 1.0;
  return out;
}

}  // namespace palpate
