// SPDX-License-Identifier: MIT
// Cholesky factors of covariances that may be singular in double precision. This file has all rules for rounding: when
// a pivot is rejected, how much jitter (variance on the diagonal) is added, and which rows are left out if no jitter
// helps. GPs, the outlier model, the belief `solids`, fits and the GP classifier use these rules.
#pragma once

#include <palpate/math.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <vector>

namespace palpate {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Factor in the bound of a pivot's rounding error. The squared pivot d^2 = diagonal - l.l has an error of up to about
/// (n + 1) * eps * diagonal (Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 10.1). A squared
/// pivot below this error has no correct digit.
constexpr double kPivotGuard = 1.0;

/// First and last amount of jitter, in units of n * eps times the largest diagonal entry. The first amount is larger
/// than rounding errors. The last amount is negligible in results: 100 * n * eps = 4e-13 for 17 rows. If a matrix is
/// not positive definite even with the last amount, rounding is not the cause.
constexpr double kFirstJitter = 10.0;
constexpr double kLastJitter = 100.0;

/// Smallest noise variance for quadratic forms that are computed with an explicit inverse, in units of n * eps times
/// the largest diagonal entry. The entries of the inverse reach 1 / noise, and a quadratic form is a small difference
/// of their products. With this noise variance, the error of the form is at most 1e-5 of the largest diagonal entry.
constexpr double kInverseNoise = 1e5;

/// Returns whether `square` is larger than its rounding error. `square` is the squared pivot of row `row` (counted from
/// 0), whose diagonal entry in the matrix is `diagonal`. Returns false for NaN.
inline bool is_regular(double square, Eigen::Index row, double diagonal) {
  return square > kPivotGuard * static_cast<double>(row + 1) * kEpsilon * diagonal;
}

/// Returns the rows of `covariance` (symmetric, n x n) that are independent in double precision. The order is that of a
/// Cholesky factorisation with diagonal pivoting: the next row is always the row with the largest residual variance.
/// Rows whose pivot is NaN or not larger than its rounding error are left out.
std::vector<int> independent_rows(const Eigen::MatrixXd& covariance);

/// Numerical diagnostics of the factorisations of one model, for the record. If the covariance of a model is factorised
/// again at every tap, the counts include every factorisation.
struct FactorReport {
  /// variance that is currently added to the diagonal in addition to the noise, in the unit of the matrix
  double jitter = 0.0;
  int raised = 0;          ///< number of increases of the jitter
  int pivoted = 0;         ///< number of factorisations of only the independent rows, because no jitter helped
  int redundant_taps = 0;  ///< number of rows that are currently left out

  /// Adds the counts of another model that has the same rows. Jitter and redundant taps become the maximum of both.
  void add(const FactorReport& other) {
    jitter = std::max(jitter, other.jitter);
    raised += other.raised;
    pivoted += other.pivoted;
    redundant_taps = std::max(redundant_taps, other.redundant_taps);
  }
};

/// Factorises n rows with the smallest sufficient amount of jitter. attempt() factorises with report.jitter and returns
/// whether all pivots are regular. While attempt() fails, the jitter is increased. If attempt() fails with the last
/// amount, regularise() calls pivot(), which must factorise only the independent rows. `scale` is the largest diagonal
/// entry.
template <class Attempt, class Pivot>
void regularise(FactorReport& report, Eigen::Index n, double scale, const Attempt& attempt, const Pivot& pivot) {
  const double unit = static_cast<double>(n) * kEpsilon * scale;
  while (!attempt()) {
    if (!(report.jitter < kLastJitter * unit)) {
      ++report.pivoted;
      pivot();
      return;
    }
    report.jitter = std::min(std::max(kFirstJitter * unit, 10.0 * report.jitter), kLastJitter * unit);
    ++report.raised;
  }
}

/// Cholesky factor L of a matrix, L L^T = K + jitter, over all rows or the independent rows.
class RegularFactor {
 public:
  /// Factorises a symmetric matrix, which includes the noise, from its lower half. The jitter starts again at 0, but
  /// the counts of the report continue. Never throws. If no row is finite, all rows are left out.
  void factorise(const Eigen::MatrixXd& matrix);

  Eigen::Index size() const { return size_; }
  const FactorReport& report() const { return report_; }

  /// Returns the sum of log L_ii over the rows of the factor, half of the log determinant.
  double half_log_determinant() const { return factor_.matrixLLT().diagonal().unaryExpr(&math::log).sum(); }

  /// Replaces b (n rows) by L^-1 b. Rows that were left out become 0.
  template <class Derived>
  void solve_lower(Eigen::MatrixBase<Derived>& b) const {
    solve_by(b, [&](auto& one) { factor_.matrixL().solveInPlace(one); });
  }
  /// Replaces b (n rows) by (K + jitter)^-1 b. Rows that were left out become 0.
  template <class Derived>
  void solve(Eigen::MatrixBase<Derived>& b) const {
    solve_by(b, [&](auto& one) {
      factor_.matrixL().solveInPlace(one);
      factor_.matrixU().solveInPlace(one);
    });
  }
  /// Returns (K + jitter)^-1, n x n. Rows and columns that were left out are 0.
  Eigen::MatrixXd inverse() const;

 private:
  template <class Derived, class Solve>
  void solve_by(Eigen::MatrixBase<Derived>& b, const Solve& solve) const {
    if (report_.redundant_taps == 0) return solve(b.derived());
    typename Derived::PlainObject some = b(rows_, Eigen::all);
    solve(some);
    b.setZero();
    for (std::size_t i = 0; i < rows_.size(); ++i) b.row(rows_[i]) = some.row(static_cast<Eigen::Index>(i));
  }
  bool try_rows(const Eigen::MatrixXd& matrix);

  Eigen::Index size_ = 0;
  std::vector<int> rows_;  ///< rows of the matrix in the order of the factor; used only if rows were left out
  Eigen::LLT<Eigen::MatrixXd> factor_;
  FactorReport report_;
};

}  // namespace palpate
