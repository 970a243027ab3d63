// SPDX-License-Identifier: MIT
// Low-rank basis of the covariances of a kernel along one axis of the candidates.
#pragma once

#include <palpate/kernel.hpp>

#include <Eigen/Core>

namespace palpate {

/// Orthonormal basis of the covariances of a kernel between the positions along one axis.
struct AxisBasis {
  Eigen::MatrixXd directions;  ///< positions x r
  /// Whether positions and kernel are symmetric about the middle. Then the first `even` directions are even functions
  /// of the position, the others odd. Without symmetry, all directions count as even.
  bool mirrored = false;
  int even = 0;

  int rank() const { return static_cast<int>(directions.cols()); }
};

/// Computes a basis whose residual variance is at most `tolerance` times the largest variance, at each of the G
/// positions. Cholesky factorisation with diagonal pivoting finds the span (Harbrecht, Peters and Schneider 2012), QR
/// factorisation the basis. Under symmetry, even and odd part are factorised separately. O(G r^2).
AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance);

/// Returns the rank of this basis, but at most `most`.
int axis_rank(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance, int most);

}  // namespace palpate
