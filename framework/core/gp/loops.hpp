// SPDX-License-Identifier: MIT
// The loops that a posterior spends its time in, in the widest vectors that the processor has (math/highway.hpp).
//
// All pointers are aligned to a cache line, and what they point to must not overlap. A number is the same on every set
// of instructions that fuses multiplications with additions, since no sum depends on the width of a vector.
#pragma once

#include <cstddef>

namespace palpate::loops {

// Memory is laid out in cache lines, whatever the width of the registers, so that no layout depends on the instruction
// set.
constexpr int kLineBytes = 64;
constexpr int kLine = kLineBytes / static_cast<int>(sizeof(double));  ///< numbers in a line
constexpr int kPanelLines = 3;                                        ///< width of a panel of a matrix, in lines
constexpr int kStripRows = 8;                                         ///< rows of a grid that are updated together
constexpr int kBlock = kStripRows * kPanelLines * kLine;              ///< cells of a dense map updated together

constexpr int kScores = 64;  ///< numbers of which the highest is found

constexpr int kMeans = 3;  ///< maps that a row is added to, at most

/// What a new row v of the posterior does to the cells of some strips, or of a piece:
///     mean_k += coefficient_k v,   variance -= v^2.
struct Update {
  int means;
  double coefficient[kMeans];
  double* mean[kMeans];
  double* variance;
};

/// A product C = A B of a few strips: 8 x depth times depth x columns each. The A of a strip has its columns one after
/// the other, 8 numbers each. B lies in panels of kPanelLines lines, each depth rows of consecutive numbers; the last
/// may be narrower. The C of the strips follow each other, each a sequence of tiles, one a panel, row by row.
struct Product {
  const double* a;
  std::size_t a_stride;  ///< numbers from one strip's A to the next
  int strips;
  const double* b;
  std::size_t panel_stride;  ///< numbers from one panel of B to the next
  int depth;
  int lines;  ///< of all columns
};

/// A product on a grid that is its own mirror image: the first `even` rows of B are the left halves of even functions
/// of the columns, the others of odd ones. So v = E + O on the left and, mirrored, E - O on the right: half of the
/// work. The cells of a tile's mirror image lie `mirror` cells beyond its own, in the same order.
struct MirroredProduct {
  Product half;
  int even;
  std::ptrdiff_t mirror;
};

/// v = (covariance - sum over i of row_i factor_i) / pivot for one piece of a dense map, taken into its maps. The rows
/// of the piece follow each other: row_i at rows + i kBlock, and v is the row after the last.
struct DenseRow {
  double* rows;
  const double* covariance;  ///< may lie in v's own place
  const double* factor;
  int depth;
  double pivot;
};

/// What becomes of a number of a map as it is read: bound to [least, most], times scale, plus offset. The product is
/// rounded by itself, so that all instruction sets read the same.
struct Reading {
  double least;
  double most;
  double scale;
  double offset;
};

/// Rows of a map's cells, `width` apart, the first number of each on a line, and where they are read to: `count`
/// numbers of each, rows `columns` apart; of mirror images each further one a place before the last. Need not be
/// aligned there.
struct Cells {
  const double* from;
  std::ptrdiff_t width;
  double* to;
  std::ptrdiff_t columns;
  int rows;
  int count;
  bool mirrored;
};

/// c = A B.
void multiply(const Product& product, double* c);
/// v = A B, which is never stored, taken into the maps.
void absorb_product(const Product& product, const Update& update);
void absorb_mirrored(const MirroredProduct& product, const Update& update);
void absorb_dense(const DenseRow& row, const Update& update);
void read(const Cells& cells, const Reading& reading);
/// out_i = the highest of the kScores numbers from `from` + i kScores on, of which none is NaN; not aligned either.
void highest(const double* from, int count, double* out);

// L is a lower triangle by rows: row i at packed_row(i), i + 1 numbers and then padding up to a line, with room for as
// many rows as whole lines have: what stands beyond row n is read and not used. Both work in place on n numbers, with
// room up to a line.
void solve_lower(const double* lower, int n, double* x);             ///< x = L^-1 x
void solve_lower_transposed(const double* lower, int n, double* x);  ///< x = L^-T x

/// Where row i of a packed lower triangle begins, in numbers. Rows are padded to lines.
std::size_t packed_row(int i);

}  // namespace palpate::loops
