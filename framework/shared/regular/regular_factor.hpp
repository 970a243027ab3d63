// SPDX-License-Identifier: MIT
// Cholesky factors of covariances that double precision may not tell from singular ones. The rules of rounding stand
// here alone: which pivot is refused, how much jitter is tried, and which rows are set aside where no jitter helps.
// Processes, the sum over outliers, the skin, the expected reductions, fits and the classifier all follow them.
#pragma once

#include <palpate/math.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace palpate {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A pivot d^2 = diagonal - l.l carries a rounding error of up to about (n + 1) eps diagonal (Higham, Accuracy and
/// Stability of Numerical Algorithms, 2002, section 10.1): one that is not above it has no correct digit.
constexpr double kPivotGuard = 1.0;

/// Jitter, in units of n eps and of the largest diagonal entry: the first amount is above what rounding can take away,
/// the last is below what anybody would see, 100 n eps = 4e-13 for 17 rows. A matrix that is not positive definite even
/// then is none that rounding made so.
constexpr double kFirstJitter = 10.0;
constexpr double kLastJitter = 100.0;

/// The least noise, in the same units, with which a quadratic form may be taken from the entries of an explicit
/// inverse. These reach 1 / noise, and the form is the small difference of their products: it is off by up to n eps /
/// noise of the largest diagonal entry, here by a hundred-thousandth.
constexpr double kInverseNoise = 1e5;

/// Returns whether `square`, the square of pivot `row` (from 0) of a matrix with this diagonal entry, is above
/// rounding. False for what is not a number.
inline bool is_regular(double square, Eigen::Index row, double diagonal) {
  return square > kPivotGuard * static_cast<double>(row + 1) * kEpsilon * diagonal;
}

/// Returns the rows of `covariance` (symmetric, n x n) that are independent in double precision, in the order of
/// a Cholesky factorisation with diagonal pivoting: each the one that is least explained by those before. Rows whose
/// pivot is not above rounding, or not a number, are left out.
std::vector<int> independent_rows(const Eigen::MatrixXd& covariance);

/// What rounding made necessary in the factorisations of one owner: it goes into the record. What is factorised anew at
/// every tap is counted anew at every tap.
struct FactorReport {
  double jitter = 0.0;     ///< variance on the diagonal beside the noise, in the unit of the matrix; as it is now
  int raised = 0;          ///< how often that was raised
  int pivoted = 0;         ///< how often no jitter helped, and independent rows were looked for
  int redundant_taps = 0;  ///< rows that do not enter now

  /// Adds the counts of another owner of the same rows, and takes the larger jitter and the more rows set aside.
  void add(const FactorReport& other) {
    jitter = std::max(jitter, other.jitter);
    raised += other.raised;
    pivoted += other.pivoted;
    redundant_taps = std::max(redundant_taps, other.redundant_taps);
  }
};

/// Factorises n rows by attempt(), which uses the report's jitter and returns whether all rows entered: with as little
/// jitter as it takes, from what the report has on, or at last by `pivot`, which takes independent rows. `scale` is the
/// largest diagonal entry.
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

/// The factor of a whole matrix at once: L L^T = K + jitter, over all rows or the independent ones.
class RegularFactor {
 public:
  /// Factorises a symmetric matrix, of which the lower half is read, noise included. Jitter begins at 0 each time; the
  /// other counts of the report go on. Never throws: of a matrix without any finite row all rows are set aside.
  void factorise(const Eigen::MatrixXd& matrix);

  Eigen::Index size() const { return size_; }
  const FactorReport& report() const { return report_; }

  /// The sum of log L_ii over the rows that entered: half of the log determinant.
  double half_log_determinant() const { return factor_.matrixLLT().diagonal().unaryExpr(&math::log).sum(); }

  /// Replaces b (n rows) by L^-1 b; rows that were set aside become 0.
  template <class Derived>
  void solve_lower(Eigen::MatrixBase<Derived>& b) const {
    solve_by(b, [&](auto& one) { factor_.matrixL().solveInPlace(one); });
  }
  /// Replaces b (n rows) by (K + jitter)^-1 b; rows that were set aside become 0.
  template <class Derived>
  void solve(Eigen::MatrixBase<Derived>& b) const {
    solve_by(b, [&](auto& one) {
      factor_.matrixL().solveInPlace(one);
      factor_.matrixU().solveInPlace(one);
    });
  }
  /// Returns (K + jitter)^-1, n x n; rows and columns that were set aside are 0.
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
  std::vector<int> rows_;  ///< those that entered, in the order of the factor; read only where some did not
  Eigen::LLT<Eigen::MatrixXd> factor_;
  FactorReport report_;
};

}  // namespace palpate
