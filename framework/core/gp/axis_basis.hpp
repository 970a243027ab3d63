// SPDX-License-Identifier: MIT
// The few directions in which the covariances of any place with a line of places lie.
#pragma once

#include <palpate/kernel.hpp>

#include <Eigen/Core>

namespace palpate {

/// An orthonormal basis of the covariances of a kernel along one axis between some places.
struct AxisBasis {
  Eigen::MatrixXd directions;  ///< places x r
  /// The places, and the kernel on them, are their own mirror image: then the first `even` directions are even, the
  /// others odd functions of the place. Without that symmetry all count as even.
  bool mirrored = false;
  int even = 0;

  int rank() const { return static_cast<int>(directions.cols()); }
};

/// The basis holds all but what is below `tolerance` times the largest variance: by Cholesky with diagonal pivoting,
/// which stops when the variance that is left at every place is as small (Harbrecht, Peters and Schneider 2012), and a
/// QR factorisation; where there is a mirror, of the even and the odd part each. O(G r^2).
AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance);

/// The rank of that basis, or `most` if it is not less.
int axis_rank(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance, int most);

}  // namespace palpate
