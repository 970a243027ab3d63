// SPDX-License-Identifier: MIT
// The loops that take most of the computing time of a posterior. They use the widest vectors of the processor
// (math/highway.hpp).
//
// All pointers are aligned to a cache line, and their arrays must not overlap. Results are equal on all instruction
// sets with fused multiplication and addition, because the order of the terms in a sum does not depend on the width of
// a vector.
#pragma once

#include <cstddef>

namespace palpate::loops {

// The layout of memory is based on cache lines. It does not depend on the width of the registers.
constexpr int kLineBytes = 64;
constexpr int kLine = kLineBytes / static_cast<int>(sizeof(double));  ///< numbers in a line
constexpr int kPanelLines = 3;                                        ///< width of a matrix panel, in lines
constexpr int kStripRows = 8;                                         ///< rows of a grid that are updated together
constexpr int kBlock = kStripRows * kPanelLines * kLine;  ///< cells of a dense map that are updated together

constexpr int kScores = 64;  ///< highest() computes one maximum per this many numbers

constexpr int kMeans = 3;  ///< largest number of maps of means

/// Update of the map cells of some strips, or of a block, by a new row v of the matrix V (see engine.hpp):
///     mean_k += coefficient_k v,   variance -= v^2.
struct Update {
  int means;
  double coefficient[kMeans];
  double* mean[kMeans];
  double* variance;
};

/// Products C = A B for several strips. For each strip, A has 8 rows and `depth` columns; B has `depth` rows and is the
/// same for all strips. A is stored by columns of 8 numbers. B is divided into panels with a width of kPanelLines cache
/// lines, and each panel is stored by rows; the last panel may be narrower. C of a strip is a sequence of tiles, one
/// per panel, and each tile is stored by rows.
struct StripProduct {
  const double* a;
  std::size_t a_stride;  ///< distance between the A of consecutive strips, in numbers
  int strips;
  const double* b;
  std::size_t panel_stride;  ///< distance between consecutive panels of B, in numbers
  int depth;
  int lines;  ///< width of B, in cache lines
};

/// Product on a grid that is symmetric in its columns. The first `even` rows of B are the left halves of even functions
/// of the column; the other rows are the left halves of odd functions. Let E be the part of the product A B from the
/// first `even` rows of B, and O the part from the other rows. Then v is E + O in the left half of the grid, and the
/// mirror image of E - O in the right half. This takes half of the multiplications of a product over all columns. The
/// cells of a tile's mirror image are `mirror` cells after the tile, in the same order.
struct MirroredProduct {
  StripProduct half;
  int even;
  std::ptrdiff_t mirror;
};

/// Computation of v = (covariance - sum over i of factor_i * row_i) / pivot for one block of a dense map. row_i begins
/// at rows + i * kBlock, and v is stored after the last row.
struct DenseRow {
  double* rows;
  const double* covariance;  ///< may have the same address as v
  const double* factor;
  int depth;
  double pivot;
};

/// Transformation of the numbers of a map: each number is bounded to [least, most], multiplied by `scale`, and
/// increased by `offset`. The product is rounded before the addition, so that all instruction sets give the same
/// result.
struct MapTransform {
  double least;
  double most;
  double scale;
  double offset;
};

/// Source and destination of a copy of map cells: `rows` rows of `count` numbers each. The first source row begins at
/// `from`, and consecutive source rows are `width` numbers apart. The first destination row begins at `to`, and
/// consecutive destination rows are `columns` numbers apart. Each source row begins at a cache line. If `mirrored` is
/// true, `to` is the last number of its row, and the rows are written backwards. `to` need not be aligned.
struct CellCopy {
  const double* from;
  std::ptrdiff_t width;
  double* to;
  std::ptrdiff_t columns;
  int rows;
  int count;
  bool mirrored;
};

/// Computes C = A B and stores it at `c`.
void multiply(const StripProduct& product, double* c);
// Compute the new row v of V (see engine.hpp) and update the maps. Only absorb_dense() stores v.
void absorb_product(const StripProduct& product, const Update& update);
void absorb_mirrored(const MirroredProduct& product, const Update& update);
void absorb_dense(const DenseRow& row, const Update& update);
void read(const CellCopy& cells, const MapTransform& reading);
/// Computes `count` maxima: out_i is the largest of the kScores numbers that begin at `from` + i * kScores. No number
/// may be NaN. The pointers need not be aligned.
void highest(const double* from, int count, double* out);

// L is a lower triangle, stored by rows. Row i begins at packed_row(i), and has i + 1 numbers and padding up to a
// multiple of a cache line. The memory of L has a multiple of kLine rows, because rows beyond n are read, although they
// do not affect the result. x has n numbers, and its memory has a multiple of kLine numbers.
void solve_lower(const double* lower, int n, double* x);             ///< x = L^-1 x
void solve_lower_transposed(const double* lower, int n, double* x);  ///< x = L^-T x

/// Returns the offset of row i in the memory of a packed lower triangle, in numbers.
std::size_t packed_row(int i);

}  // namespace palpate::loops
