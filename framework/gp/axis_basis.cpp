// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"

#include <Eigen/QR>

#include <cmath>

namespace palpate {

Eigen::MatrixXd axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance) {
  const Eigen::Index size = places.size();
  Eigen::VectorXd left(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::Matrix<double, 1, 1> own;
    kernel.axis_covariance(axis, places.segment(i, 1), places.segment(i, 1), own);
    left(i) = own(0);
  }
  const double enough = tolerance * left.maxCoeff();
  Eigen::MatrixXd columns(size, std::min<Eigen::Index>(size, 32));
  Eigen::Index rank = 0;
  while (rank < size) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > enough)) break;
    if (rank == columns.cols()) columns.conservativeResize(Eigen::NoChange, std::min(size, 2 * rank));
    auto column = columns.col(rank);
    kernel.axis_covariance(axis, places, places.segment(pivot, 1), column);
    column.noalias() -= columns.leftCols(rank) * columns.row(pivot).head(rank).transpose();
    column /= std::sqrt(left(pivot));
    left -= column.cwiseAbs2();
    left(pivot) = 0.0;
    ++rank;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns.leftCols(rank));
  return qr.householderQ() * Eigen::MatrixXd::Identity(size, rank);
}

}  // namespace palpate
