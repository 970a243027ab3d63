// SPDX-License-Identifier: MIT
// The Cholesky factor of a covariance matrix that grows by one row a tap.
#pragma once

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// L with L L^T = K, rows appended at O(n^2) each; earlier rows never change.
class Factor {
 public:
  /// Appends the point whose covariance with the n points before is `covariance` and with itself `diagonal` (noise and
  /// jitter included). Returns false, and leaves the factor as it was, when the pivot is not above what rounding
  /// alone can produce (kPivotGuard): the matrix is then not positive definite in double precision.
  bool append(const VectorView& covariance, double diagonal);

  void clear();

  int size() const { return size_; }

  /// The last row without its pivot: l = L^-1 covariance; n - 1 values.
  VectorView last_row() const { return rows_.col(size_ - 1).head(size_ - 1); }
  double last_pivot() const { return rows_(size_ - 1, size_ - 1); }

  /// log det K = 2 sum log L_ii.
  double log_determinant() const { return log_determinant_; }

  /// An estimate of the condition number of K in the 2-norm, by incremental condition estimation (Bischof 1990): the
  /// extreme singular vectors of L are carried along at O(n) a row. A lower bound, most often within a factor of 3;
  /// 1 for an empty factor.
  double condition() const { return size_ == 0 ? 1.0 : (largest_.value / smallest_.value); }

 private:
  /// An approximate singular vector x of L, |x| = 1, and |L x|^2.
  struct Extreme {
    Eigen::VectorXd vector;
    double value = 0.0;
  };
  void follow(Extreme& extreme, bool largest) const;

  int size_ = 0;
  Eigen::MatrixXd rows_;  ///< row i of L in column i: what the forward substitution reads is contiguous
  double log_determinant_ = 0.0;
  Extreme largest_;
  Extreme smallest_;
};

/// The rows of `covariance` (symmetric, n x n) that are independent in double precision, in the order of
/// a Cholesky factorisation with diagonal pivoting: each the one that is least explained by those before. Rows whose
/// pivot is not above kPivotGuard, or not a number, are left out.
std::vector<int> independent_rows(const Eigen::MatrixXd& covariance);

}  // namespace palpate
