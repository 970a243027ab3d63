// SPDX-License-Identifier: MIT
// The Cholesky factor of a covariance matrix that grows by one row a tap.
#pragma once

#include "gp/panels.hpp"

#include <palpate/types.hpp>

#include <Eigen/Core>

namespace palpate {

/// L with L L^T = K, rows appended at O(n^2) each; earlier rows never change. n (n + 9) / 2 numbers of memory.
class Factor {
 public:
  /// Room for so many rows.
  void reserve(int rows);

  /// Appends the point whose covariance with the n points before is `covariance` and with itself `diagonal` (noise and
  /// jitter included). Returns false, and leaves the factor as it was, when the pivot is not above what rounding
  /// alone can produce (is_regular()): the matrix is then not positive definite in double precision.
  bool append(const VectorView& covariance, double diagonal);

  void clear();

  int size() const { return size_; }

  /// Row i without its pivot: l = L^-1 covariance; i values.
  VectorView row(int i) const { return Eigen::Map<const Eigen::VectorXd>(packed(i), i); }
  double pivot(int i) const { return packed(i)[i]; }

  /// Row i of L^-1, i + 1 values, into `out` of as many. O(i^2).
  void inverse_row(int i, VectorOut out);

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
  const double* packed(int i) const { return rows_.data() + loops::packed_row(i); }

  int size_ = 0;
  int capacity_ = 0;
  loops::Lines rows_;     ///< packed: see loops.hpp
  loops::Lines scratch_;  ///< a vector, aligned
  double log_determinant_ = 0.0;
  Extreme largest_;
  Extreme smallest_;
};

}  // namespace palpate
