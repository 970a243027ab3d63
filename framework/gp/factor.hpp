// SPDX-License-Identifier: MIT
// Cholesky factor of a covariance matrix that grows by one row per tap.
#pragma once

#include "gp/aligned_matrices.hpp"

#include <palpate/types.hpp>

#include <Eigen/Core>

namespace palpate {

/// Lower triangle L with L L^T = K. Appending a row costs O(n^2) and keeps the earlier rows. Memory: n (n + 9) / 2
/// numbers.
class Factor {
 public:
  /// Reserves memory for this many rows.
  void reserve(int rows);

  /// Appends a point. `covariance`: covariances with the n earlier points; `diagonal`: variance of the point, noise and
  /// jitter included. Returns false and changes nothing if the pivot is not larger than its rounding error
  /// (is_regular()). The matrix is then not positive definite in double precision.
  bool append(const VectorView& covariance, double diagonal);

  void clear();

  int size() const { return size_; }

  /// Returns row i of L without its pivot: i values.
  VectorView row(int i) const { return Eigen::Map<const Eigen::VectorXd>(packed(i), i); }
  double pivot(int i) const { return packed(i)[i]; }

  /// Computes row i of L^-1 into `out`, i + 1 values. O(i^2).
  void inverse_row(int i, VectorOut out);

  /// Returns log det K, which is twice the sum of log L_ii.
  double log_determinant() const { return log_determinant_; }

  /// Estimates the condition number of K in the 2-norm by incremental condition estimation (Bischof 1990), which
  /// updates the extreme singular vectors of L at O(n) per row. The estimate is a lower bound, usually within a factor
  /// of 3. Returns 1 for an empty factor.
  double condition() const { return size_ == 0 ? 1.0 : (largest_.value / smallest_.value); }

 private:
  /// Approximate singular vector x of L with |x| = 1, and the value |L x|^2.
  struct SingularPair {
    Eigen::VectorXd vector;
    double value = 0.0;
  };
  void update(SingularPair& extreme, bool largest) const;
  const double* packed(int i) const { return rows_.data() + loops::packed_row(i); }

  int size_ = 0;
  int capacity_ = 0;
  loops::AlignedArray rows_;     ///< packed: see vector_loops.hpp
  loops::AlignedArray scratch_;  ///< aligned memory of one vector
  double log_determinant_ = 0.0;
  SingularPair largest_;
  SingularPair smallest_;
};

}  // namespace palpate
