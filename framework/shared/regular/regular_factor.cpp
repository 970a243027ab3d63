// SPDX-License-Identifier: MIT
#include "regular/regular_factor.hpp"

#include <cmath>

namespace palpate {

std::vector<int> independent_rows(const Eigen::MatrixXd& covariance) {
  const int n = static_cast<int>(covariance.rows());
  Eigen::VectorXd residual = covariance.diagonal();  // residual variance given the chosen rows
  const Eigen::VectorXd own = residual;
  std::vector<int> order;
  Eigen::MatrixXd columns(n, n);
  while (static_cast<int>(order.size()) < n) {
    int best = -1;
    for (int i = 0; i < n; ++i) {
      const bool independent = is_regular(residual(i), n - 1, own(i)) && residual(i) > 0.0;
      if (independent && (best < 0 || residual(i) > residual(best))) best = i;
    }
    if (best < 0) break;
    const auto k = static_cast<Eigen::Index>(order.size());
    auto column = columns.col(k);
    column = covariance.col(best);
    if (k > 0) column.noalias() -= columns.leftCols(k) * columns.row(best).head(k).transpose();
    column /= std::sqrt(residual(best));
    residual -= column.cwiseAbs2();
    residual(best) = 0.0;  // excludes the row from now on
    order.push_back(best);
  }
  return order;
}

/// Factorises a matrix that includes the jitter. Returns whether all pivots are regular.
bool RegularFactor::try_rows(const Eigen::MatrixXd& matrix) {
  factor_.compute(matrix);
  if (factor_.info() != Eigen::Success) return false;
  const auto pivots = factor_.matrixLLT().diagonal();
  for (Eigen::Index i = 0; i < pivots.size(); ++i) {
    if (!is_regular(pivots(i) * pivots(i), i, matrix(i, i))) return false;
  }
  return true;
}

void RegularFactor::factorise(const Eigen::MatrixXd& matrix) {
  size_ = matrix.rows();
  report_.jitter = 0.0;
  report_.redundant_taps = 0;
  Eigen::MatrixXd raised;
  const auto with_jitter = [&]() -> const Eigen::MatrixXd& {
    if (report_.jitter == 0.0) return matrix;
    raised = matrix;
    raised.diagonal().array() += report_.jitter;
    return raised;
  };
  const auto pivot = [&] {
    const Eigen::MatrixXd all = with_jitter().selfadjointView<Eigen::Lower>();
    rows_ = independent_rows(all);
    // The pivots of independent_rows() and try_rows() differ by rounding. Rows are removed from the end until
    // try_rows() succeeds.
    while (!rows_.empty() && !try_rows(all(rows_, rows_))) rows_.pop_back();
    if (rows_.empty()) factor_.compute(Eigen::MatrixXd(0, 0));
    report_.redundant_taps = static_cast<int>(size_) - static_cast<int>(rows_.size());
  };
  regularise(
      report_, size_, size_ == 0 ? 0.0 : matrix.diagonal().maxCoeff(), [&] { return try_rows(with_jitter()); }, pivot);
}

Eigen::MatrixXd RegularFactor::inverse() const {
  if (report_.redundant_taps == 0) return factor_.solve(Eigen::MatrixXd::Identity(size_, size_));
  Eigen::MatrixXd out = Eigen::MatrixXd::Identity(size_, size_);
  solve(out);
  return out;
}

}  // namespace palpate
