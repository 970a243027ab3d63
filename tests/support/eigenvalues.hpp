// SPDX-License-Identifier: MIT
// Compiled once, because Eigen's solver takes ten seconds to compile.
#pragma once

#include <Eigen/Core>

namespace palpate::test {

/// Those of a symmetric matrix, in increasing order; only the lower triangle is read.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

}  // namespace palpate::test
