// SPDX-License-Identifier: MIT
#include "symmetric.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace palpate::fitting {
namespace {

/// Blocks up to this size are done column by column: packing for matrix products would cost more than it saves.
constexpr Eigen::Index kBlock = 64;

/// Cholesky factorisation of a block, each column from all those before it.
bool factorise_block(MatrixOut l) {
  const Eigen::Index n = l.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    auto column = l.col(j).tail(n - j);
    if (j > 0) column.noalias() -= l.block(j, 0, n - j, j) * l.row(j).head(j).transpose();
    if (!(column(0) > 0.0)) return false;
    column /= std::sqrt(column(0));
  }
  return l.diagonal().allFinite();
}

/// L -> L^-1, lower triangular. With L = [A 0; B C]: L^-1 = [A^-1 0; -C^-1 B A^-1, C^-1].
void invert_triangle(MatrixOut l) {
  const Eigen::Index n = l.rows();
  if (n > kBlock) {
    const Eigen::Index half = n / 2;
    const Eigen::Index rest = n - half;
    invert_triangle(l.topLeftCorner(half, half));
    invert_triangle(l.bottomRightCorner(rest, rest));
    auto b = l.bottomLeftCorner(rest, half);
    const Eigen::MatrixXd left = l.bottomRightCorner(rest, rest).triangularView<Eigen::Lower>() * b;
    b.noalias() = -left * l.topLeftCorner(half, half).triangularView<Eigen::Lower>();
    return;
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    const Eigen::Index below = n - j - 1;
    const double own = 1.0 / l(j, j);
    l(j, j) = own;
    auto column = l.col(j).tail(below);
    // column <- -own C^-1 column, C^-1 being what is done already; from the last entry on, so that it works in place.
    for (Eigen::Index k = below - 1; k >= 0; --k) {
      const double value = -own * column(k);
      column.tail(below - k - 1) += value * l.col(j + 1 + k).tail(below - k - 1);
      column(k) = value * l(j + 1 + k, j + 1 + k);
    }
  }
}

/// L -> lower triangle of L^T L. With L = [A 0; B C]: [A^T A + B^T B, ...; C^T B, C^T C].
void square_triangle(MatrixOut l) {
  const Eigen::Index n = l.rows();
  if (n > kBlock) {
    const Eigen::Index half = n / 2;
    const Eigen::Index rest = n - half;
    square_triangle(l.topLeftCorner(half, half));
    auto b = l.bottomLeftCorner(rest, half);
    l.topLeftCorner(half, half).selfadjointView<Eigen::Lower>().rankUpdate(b.transpose());
    const Eigen::MatrixXd left = l.bottomRightCorner(rest, rest).transpose().triangularView<Eigen::Upper>() * b;
    b = left;
    square_triangle(l.bottomRightCorner(rest, rest));
    return;
  }
  // Column j needs the rows from i >= j on only, and those of later columns: from left to right in place.
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) l(i, j) = l.col(i).tail(n - i).dot(l.col(j).tail(n - i));
  }
}

}  // namespace

bool factorise(MatrixOut matrix) {
  if (matrix.rows() <= kBlock) return factorise_block(matrix);
  const Eigen::LLT<MatrixOut> llt(matrix);
  return llt.info() == Eigen::Success && matrix.diagonal().allFinite();
}

// A view goes by value although it is written through. NOLINTNEXTLINE(performance-unnecessary-value-param)
void invert_factored(MatrixOut matrix) {
  invert_triangle(matrix);
  square_triangle(matrix);
}

void mirror(MatrixOut matrix) { matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose(); }

}  // namespace palpate::fitting
