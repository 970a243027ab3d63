// SPDX-License-Identifier: MIT
#include "gp/candidate_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

Eigen::VectorXd centres(double side, int count) {
  Eigen::VectorXd out(count);
  for (int i = 0; i < count; ++i) out(i) = (i + 0.5) * side / count;
  return out;
}

CandidateGrid grid(const Area& area, int columns, int rows) {
  return product_grid(centres(area.width, columns), centres(area.depth, rows));
}

int cell(double position, double side, int count) {
  return static_cast<int>(std::clamp(std::floor(position / side * count), 0.0, count - 1.0));
}

}  // namespace

int CandidateGrid::nearest(double x, double y, const Area& area) const {
  return cell(y, area.depth, rows) * columns + cell(x, area.width, columns);
}

CandidateGrid product_grid(Eigen::VectorXd xs, Eigen::VectorXd ys) {
  const auto columns = static_cast<int>(xs.size());
  const auto rows = static_cast<int>(ys.size());
  CandidateGrid out{columns, rows, Points(columns * rows, 2), std::move(xs), std::move(ys)};
  for (int row = 0; row < rows; ++row) {
    out.points.block(row * columns, 0, columns, 1) = out.xs;
    out.points.block(row * columns, 1, columns, 1).setConstant(out.ys(row));
  }
  return out;
}

CandidateGrid grid_by_count(const Area& area, int count) { return grid(area, count, count); }

CandidateGrid grid_by_spacing(const Area& area, double spacing) {
  const auto cells = [spacing](double side) { return static_cast<int>(cells_along(side, spacing)); };
  return grid(area, cells(area.width), cells(area.depth));
}

double cells_along(double side, double spacing) { return std::max(1.0, std::round(side / spacing)); }

CandidateGrid grid_of(const Candidates& candidates) {
  CandidateGrid out;
  out.columns = candidates.columns;
  out.rows = candidates.rows;
  out.points = candidates.starts.leftCols<2>();
  out.xs = out.points.col(0).head(out.columns);
  out.ys = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>(out.points.col(1).data(), out.rows,
                                                                      Eigen::InnerStride<>(out.columns));
  return out;
}

}  // namespace palpate
