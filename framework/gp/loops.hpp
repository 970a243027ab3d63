// SPDX-License-Identifier: MIT
// The loops that take most of the time of a posterior, with the widest vectors of the processor (math/highway.hpp).
//
// All pointers are aligned to a cache line, and their arrays must not overlap. Results are equal on all instruction
// sets with fused multiplication and addition, because no sum depends on the width of a vector.
#pragma once

#include <cstddef>

namespace palpate::loops {

// The layout of memory is in cache lines, and does not depend on the width of the registers.
constexpr int kLineBytes = 64;
constexpr int kLine = kLineBytes / static_cast<int>(sizeof(double));  ///< numbers in a line
constexpr int kPanelLines = 3;                                        ///< width of a matrix panel, in lines
constexpr int kStripRows = 8;                                         ///< rows of a grid that are updated together
constexpr int kBlock = kStripRows * kPanelLines * kLine;  ///< cells of a dense map that are updated together

constexpr int kScores = 64;  ///< numbers per maximum of highest()

constexpr int kMeans = 3;  ///< largest number of maps of means

/// Update of the cells of some strips, or of a block, by a new row v of the posterior:
///     mean_k += coefficient_k v,   variance -= v^2.
struct Update {
  int means;
  double coefficient[kMeans];
  double* mean[kMeans];
  double* variance;
};

/// Products C = A B of several strips, 8 x depth times depth x columns each. A is stored by columns of 8 numbers. B is
/// divided into panels of kPanelLines lines, stored by rows; the last panel may be narrower. C of each strip is a
/// sequence of tiles, one per panel, stored by rows.
struct Product {
  const double* a;
  std::size_t a_stride;  ///< numbers from one strip's A to the next
  int strips;
  const double* b;
  std::size_t panel_stride;  ///< numbers from one panel of B to the next
  int depth;
  int lines;  ///< width of B
};

/// Product on a grid that is symmetric in its columns. The first `even` rows of B are left halves of even functions of
/// the column, the others of odd functions. So v = E + O on the left and, mirrored, E - O on the right, for half of the
/// multiplications. The cells of a tile's mirror image follow `mirror` cells after the tile, in the same order.
struct MirroredProduct {
  Product half;
  int even;
  std::ptrdiff_t mirror;
};

/// v = (covariance - sum over i of row_i factor_i) / pivot for one block of a dense map. row_i is at rows + i kBlock,
/// and v is stored after the last row.
struct DenseRow {
  double* rows;
  const double* covariance;  ///< may be the memory of v
  const double* factor;
  int depth;
  double pivot;
};

/// Transformation of a map's number: bounded to [least, most], times scale, plus offset. The product is rounded before
/// the sum, so that all instruction sets give the same result.
struct Reading {
  double least;
  double most;
  double scale;
  double offset;
};

/// Copy of a map's cells: `rows` rows of `count` numbers from `from`, `width` apart, to `to`, `columns` apart. Each row
/// of `from` begins at a cache line. If `mirrored`, a row of `to` is written from its end backwards. `to` need not be
/// aligned.
struct Cells {
  const double* from;
  std::ptrdiff_t width;
  double* to;
  std::ptrdiff_t columns;
  int rows;
  int count;
  bool mirrored;
};

/// Computes c = A B.
void multiply(const Product& product, double* c);
// Compute v and update the maps. v of a product is not stored.
void absorb_product(const Product& product, const Update& update);
void absorb_mirrored(const MirroredProduct& product, const Update& update);
void absorb_dense(const DenseRow& row, const Update& update);
void read(const Cells& cells, const Reading& reading);
/// Computes out_i, the largest of the kScores numbers from `from` + i kScores on. No number is NaN. The pointers need
/// not be aligned.
void highest(const double* from, int count, double* out);

// L is a lower triangle, stored by rows: row i at packed_row(i), i + 1 numbers and padding up to a line. Its memory has
// rows up to a multiple of a line, because rows beyond n are read without effect. x has n numbers, its memory also up
// to a multiple of a line.
void solve_lower(const double* lower, int n, double* x);             ///< x = L^-1 x
void solve_lower_transposed(const double* lower, int n, double* x);  ///< x = L^-T x

/// Returns the beginning of row i of a packed lower triangle, in numbers.
std::size_t packed_row(int i);

}  // namespace palpate::loops
