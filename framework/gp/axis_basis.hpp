// SPDX-License-Identifier: MIT
// The few directions in which the covariances of any place with a line of places lie.
#pragma once

#include <palpate/kernel.hpp>

#include <Eigen/Core>

namespace palpate {

/// An orthonormal basis (places x r) of the covariances of `kernel` along `axis` between `places`, but for what is
/// below `tolerance` times the largest variance: by Cholesky with diagonal pivoting, which stops when the variance that
/// is left at every place is as small (Harbrecht, Peters and Schneider 2012), and a QR factorisation. O(G r^2).
Eigen::MatrixXd axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance);

}  // namespace palpate
