// SPDX-License-Identifier: MIT
// The hot loops of the posterior, once for each instruction set, and the choice among them.
//
// This header is read by translation units that are compiled for different instruction sets. Nothing in it has code:
// an inline function would be emitted by each of them, and the linker would keep any one for all.
#pragma once

#include <cstddef>

namespace palpate::simd {

// Memory is laid out in cache lines, whatever the width of the registers, so that no layout depends on the instruction
// set. All pointers below are aligned to a line; what they point to must not overlap.
constexpr int kLineBytes = 64;
constexpr int kLine = kLineBytes / static_cast<int>(sizeof(double));  ///< numbers in a line
constexpr int kPanelLines = 3;                                        ///< width of a panel of a matrix, in lines
constexpr int kStripRows = 8;                                         ///< rows of a grid that are updated together
constexpr int kPiece = kStripRows * kPanelLines * kLine;              ///< cells of a dense map updated together

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
/// of the piece follow each other: row_i at rows + i kPiece, and v is the row after the last.
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

struct Table {
  const char* name;
  /// c = A B.
  void (*multiply)(const Product&, double* c);
  /// v = A B, which is never stored, taken into the maps.
  void (*absorb_product)(const Product&, const Update&);
  void (*absorb_mirrored)(const MirroredProduct&, const Update&);
  void (*absorb_dense)(const DenseRow&, const Update&);
  void (*read)(const Cells&, const Reading&);
  /// out_i = the highest of the kScores numbers from `from` + i kScores on, of which none is NaN; not aligned either.
  void (*highest)(const double* from, int count, double* out);
  // L is a lower triangle by rows: row i at packed_row(i), i + 1 numbers and then padding up to a line, as far as the
  // matrix goes. Both work in place on n numbers, with room up to a line.
  void (*solve_lower)(const double* lower, int n, double* x);             ///< x = L^-1 x
  void (*solve_lower_transposed)(const double* lower, int n, double* x);  ///< x = L^-T x
};

enum class Lanes;  // palpate/simd.hpp
const Table& table_of(Lanes lanes);
/// The fastest of SSE2, AVX2 + FMA and AVX-512 that this processor has.
const Table& fastest();
/// SSE2, which every x86-64 has.
const Table& baseline();

// Each defined in a translation unit of its own. The tests run those that the processor has.
extern const Table kSse2;
extern const Table kAvx2;
extern const Table kAvx512;

/// Whether this processor can run `table`.
bool runs(const Table& table);

/// Where row i of a packed lower triangle begins, in numbers. Rows are padded to lines.
std::size_t packed_row(int i);

}  // namespace palpate::simd
