// SPDX-License-Identifier: MIT
// Dense symmetric positive definite matrices, where a fit spends most of its time. All three algorithms consist of two
// steps: product of tiles, and solution with a tile's triangle. They use the widest vectors of the processor
// (math/highway.hpp).
#pragma once

#include <palpate/types.hpp>

#include <cstddef>
#include <vector>

namespace palpate::fitting {

/// Eight consecutive rows of a column: a column of a strip, and a cache line.
struct alignas(64) Line {
  double numbers[8];
};

/// A square matrix of n rows, stored in strips of eight rows, column by column. A tile is eight columns of a strip.
/// Rows and columns beyond n, up to a whole tile, are 0 unless stated otherwise.
class StripMatrix {
 public:
  explicit StripMatrix(Eigen::Index n)
      : size_(n), strips_((n + 7) / 8), lines_(static_cast<std::size_t>(strips_ * stride())) {}

  Eigen::Index size() const { return size_; }
  Eigen::Index strips() const { return strips_; }
  /// Returns column `j` of strip `s`; the next column follows in memory.
  Line* at(Eigen::Index s, Eigen::Index j) { return &lines_[static_cast<std::size_t>(s * stride() + j)]; }
  const Line* at(Eigen::Index s, Eigen::Index j) const { return &lines_[static_cast<std::size_t>(s * stride() + j)]; }
  double& operator()(Eigen::Index i, Eigen::Index j) { return at(i / 8, j)->numbers[i % 8]; }
  double operator()(Eigen::Index i, Eigen::Index j) const { return at(i / 8, j)->numbers[i % 8]; }

  /// Sets column j from the first row of its tile on. `values` has one number per remaining row.
  void put(Eigen::Index j, const Eigen::VectorXd& values);
  /// Returns the full matrix from the entries on and below the diagonal.
  Eigen::MatrixXd mirrored() const;

 private:
  /// Number of lines per strip. The additional line avoids strips at distances of powers of two, which would share
  /// cache sets.
  Eigen::Index stride() const { return 8 * strips_ + 1; }

  Eigen::Index size_;
  Eigen::Index strips_;
  std::vector<Line> lines_;
};

/// Replaces K by L with L L^T = K, on and below the diagonal. Entries above it in diagonal tiles are undefined. Rows
/// beyond n become those of the identity, and `reciprocals` those of the diagonal. Returns false, with undefined
/// content, if K is not positive definite or not finite.
bool factorise(StripMatrix& matrix, std::vector<double>& reciprocals);

/// Computes L^-1 b in place, for n numbers.
void solve_lower(const StripMatrix& factor, VectorOut b);

/// Computes L^-T on and above the diagonal, from the result of factorise(). `out` has the size of `factor`.
void invert_transposed(const StripMatrix& factor, const std::vector<double>& reciprocals, StripMatrix& out);

/// Computes U b in place, for an upper triangle U.
void multiply_upper(const StripMatrix& upper, VectorOut b);

/// Computes U U^T on and below the diagonal and in all diagonal tiles. For U = L^-T the result is K^-1.
void square_upper(const StripMatrix& upper, StripMatrix& out);

}  // namespace palpate::fitting
