// SPDX-License-Identifier: MIT
// Dense symmetric positive definite matrices. A fit spends most of its time on them. All three algorithms consist of
// two steps: the product of tiles, and the solution with the triangle of a tile. They use the widest vector registers
// of the processor (math/highway.hpp).
#pragma once

#include <palpate/types.hpp>

#include <cstddef>
#include <vector>

namespace palpate::fitting {

/// Eight consecutive rows of a column. This is one column of a strip, and one cache line.
struct alignas(64) ColumnPack {
  double numbers[8];
};

/// A square matrix of n rows, stored in strips of eight rows, column by column. A tile is eight columns of a strip.
/// Rows and columns beyond n, up to a whole tile, are 0 unless a function states otherwise.
class StripMatrix {
 public:
  explicit StripMatrix(Eigen::Index n)
      : size_(n), strips_((n + 7) / 8), lines_(static_cast<std::size_t>(strips_ * stride())) {}

  Eigen::Index size() const { return size_; }
  Eigen::Index strips() const { return strips_; }
  /// Returns column `j` of strip `s`. The next column follows in memory.
  ColumnPack* at(Eigen::Index s, Eigen::Index j) { return &lines_[static_cast<std::size_t>(s * stride() + j)]; }
  const ColumnPack* at(Eigen::Index s, Eigen::Index j) const {
    return &lines_[static_cast<std::size_t>(s * stride() + j)];
  }
  double& operator()(Eigen::Index i, Eigen::Index j) { return at(i / 8, j)->numbers[i % 8]; }
  double operator()(Eigen::Index i, Eigen::Index j) const { return at(i / 8, j)->numbers[i % 8]; }

  /// Sets column `j` from the first row of its diagonal tile to the last row of the matrix. `values` has one number for
  /// each of these rows.
  void put(Eigen::Index j, const Eigen::VectorXd& values);
  /// Returns the full matrix from the entries on and below the diagonal.
  Eigen::MatrixXd mirrored() const;

 private:
  /// Number of lines per strip. The additional line keeps the strips from having a distance that is a power of two.
  /// Strips at such distances would share cache sets.
  Eigen::Index stride() const { return 8 * strips_ + 1; }

  Eigen::Index size_;
  Eigen::Index strips_;
  std::vector<ColumnPack> lines_;
};

/// Replaces K by L with L * L^T = K, on the diagonal and below it. In diagonal tiles, the entries above the diagonal
/// are undefined. Rows beyond n become rows of the identity. `reciprocals` receives the reciprocals of the diagonal. If
/// K is not positive definite or not finite, returns false and leaves the content undefined.
bool factorise(StripMatrix& matrix, std::vector<double>& reciprocals);

/// Computes L^-1 * b in place, for n numbers.
void solve_lower(const StripMatrix& factor, VectorOut b);

/// Computes L^-T on the diagonal and above it, from the result of factorise(). `out` must have the size of `factor`.
void invert_transposed(const StripMatrix& factor, const std::vector<double>& reciprocals, StripMatrix& out);

/// Computes U * b in place, where U is an upper triangular matrix.
void multiply_upper(const StripMatrix& upper, VectorOut b);

/// Computes U * U^T on the diagonal, below it, and in all diagonal tiles. For U = L^-T the result is K^-1.
void square_upper(const StripMatrix& upper, StripMatrix& out);

}  // namespace palpate::fitting
