// SPDX-License-Identifier: MIT
#include "support/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace palpate::test {

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  return symmetric.selfadjointView<Eigen::Lower>().eigenvalues();
}

}  // namespace palpate::test
