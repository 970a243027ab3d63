// SPDX-License-Identifier: MIT
// The Cholesky factor of a covariance matrix that grows by one row a tap.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

namespace palpate {

/// L with L L^T = K, rows appended at O(n^2) each; earlier rows never change.
class Factor {
 public:
  /// Appends the point whose covariance with the n points before is `covariance` and with itself `diagonal` (noise and
  /// jitter included). Returns false, and leaves the factor as it was, when the pivot is not above what rounding
  /// alone can produce: the matrix is then not positive definite in double precision.
  ///
  /// The guard: a pivot d^2 = diagonal - l.l carries a rounding error of up to about (n + 1) eps diagonal (Higham,
  /// Accuracy and Stability of Numerical Algorithms, 2002, section 10.1), so a smaller one has no correct digit.
  bool append(const VectorView& covariance, double diagonal);

  void clear();

  int size() const { return size_; }

  /// The last row without its pivot: l = L^-1 covariance; n - 1 values.
  VectorView last_row() const { return rows_.col(size_ - 1).head(size_ - 1); }
  double last_pivot() const { return rows_(size_ - 1, size_ - 1); }

  /// log det K = 2 sum log L_ii.
  double log_determinant() const { return log_determinant_; }

  /// (max L_ii / min L_ii)^2: a lower bound of the condition number of K, usually within a factor of n of it. 1 for
  /// an empty factor.
  double condition() const;

 private:
  int size_ = 0;
  Eigen::MatrixXd rows_;  ///< row i of L in column i: what the forward substitution reads is contiguous
  double log_determinant_ = 0.0;
  double largest_ = 0.0;
  double smallest_ = 0.0;
};

}  // namespace palpate
