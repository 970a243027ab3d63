// SPDX-License-Identifier: MIT
#include "gp/candidate_grid.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

int cell(double position, double side, int count) {
  return static_cast<int>(std::clamp(std::floor(position / side * count), 0.0, count - 1.0));
}

}  // namespace

int CandidateGrid::nearest(double x, double y, const Area& area) const {
  return cell(y, area.depth, rows) * columns + cell(x, area.width, columns);
}

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
