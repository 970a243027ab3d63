// SPDX-License-Identifier: MIT
// Low-rank basis of a kernel's covariance matrix along one axis of the candidate grid.
#pragma once

#include <palpate/kernel.hpp>

#include <Eigen/Core>

namespace palpate {

/// Orthonormal basis of the covariance matrix of a kernel between the positions along one axis.
struct AxisBasis {
  Eigen::MatrixXd directions;  ///< one row per position, one column per direction
  /// Whether positions and kernel are symmetric about the middle. If so, the first `even` directions are even functions
  /// of the position, and the others are odd functions. If not, all directions count as even.
  bool mirrored = false;
  int even = 0;

  int rank() const { return static_cast<int>(directions.cols()); }
};

/// Computes a basis for G positions. At each position, the basis leaves out a variance of at most `tolerance` times the
/// largest variance. A Cholesky factorisation with diagonal pivoting finds the span (Harbrecht, Peters and Schneider
/// 2012), and a QR factorisation finds the basis. If positions and kernel are symmetric, the even part and the odd part
/// of the matrix are factorised separately. Cost for rank r: O(G r^2).
AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance);

/// Returns the rank of the basis that axis_basis() computes, or `most` if the rank is larger.
int axis_rank(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance, int most);

}  // namespace palpate
