// SPDX-License-Identifier: MIT
// Dense symmetric positive definite matrices: a fit spends its time here. All three algorithms are made of the same two
// steps, the product of tiles and the solution by a tile's triangle, in the widest vectors that the processor has
// (math/highway.hpp).
#pragma once

#include <palpate/types.hpp>

#include <cstddef>
#include <vector>

namespace palpate::fitting {

/// Eight numbers below each other: a column of a strip, and a cache line.
struct alignas(64) Line {
  double numbers[8];
};

/// A square matrix of n rows in strips of eight rows, the columns of each one after the other. A tile is eight columns
/// of a strip. Rows and columns beyond n, up to a whole tile, are there: 0 unless said.
class Strips {
 public:
  explicit Strips(Eigen::Index n)
      : size_(n), strips_((n + 7) / 8), lines_(static_cast<std::size_t>(strips_ * stride())) {}

  Eigen::Index size() const { return size_; }
  Eigen::Index strips() const { return strips_; }
  /// Column `j` of strip `s`; the next column follows.
  Line* at(Eigen::Index s, Eigen::Index j) { return &lines_[static_cast<std::size_t>(s * stride() + j)]; }
  const Line* at(Eigen::Index s, Eigen::Index j) const { return &lines_[static_cast<std::size_t>(s * stride() + j)]; }
  double& operator()(Eigen::Index i, Eigen::Index j) { return at(i / 8, j)->numbers[i % 8]; }
  double operator()(Eigen::Index i, Eigen::Index j) const { return at(i / 8, j)->numbers[i % 8]; }

  /// Column j, from the first row of its tile on: `values` has as many numbers as rows are left.
  void put(Eigen::Index j, const Eigen::VectorXd& values);
  /// All of it, from what is on and below the diagonal.
  Eigen::MatrixXd mirrored() const;

 private:
  /// One line more than the columns: strips that begin a power of two apart would meet in the same places of a cache.
  Eigen::Index stride() const { return 8 * strips_ + 1; }

  Eigen::Index size_;
  Eigen::Index strips_;
  std::vector<Line> lines_;
};

/// K -> L with L L^T = K, on and below the diagonal; what is above it in tiles of the diagonal is lost. Rows beyond n
/// become those of the identity. `reciprocals` become those of the diagonal. False when K is not positive definite or
/// not finite; then its content is lost.
bool factorise(Strips& matrix, std::vector<double>& reciprocals);

/// L^-1 b, in place; n numbers.
void solve_lower(const Strips& factor, VectorOut b);

/// L -> L^-T, on and above the diagonal, by its factorise(); `out` is of the same size.
void invert_transposed(const Strips& factor, const std::vector<double>& reciprocals, Strips& out);

/// U b in place, of an upper triangle.
void multiply_upper(const Strips& upper, VectorOut b);

/// U -> U U^T, on and below the diagonal and in all of its tiles; of U = L^-T it is K^-1.
void square_upper(const Strips& upper, Strips& out);

}  // namespace palpate::fitting
