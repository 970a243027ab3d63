// SPDX-License-Identifier: MIT
// Memory of the maps over the candidates in the layout of the loops (vector_loops.hpp), and the mapping from cells to
// candidates.
#pragma once

#include "gp/aligned_matrices.hpp"
#include "gp/candidate_grid.hpp"
#include "gp/workers.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

namespace palpate {

/// The cells of a tile that belong to candidates: `rows` rows of `count` cells. The first row begins at `cell`, and the
/// distance between rows is `width`. The first row has the candidates `candidate`, `candidate` + 1, ... or, if
/// `mirrored`, `candidate`, `candidate` - 1, .... Each further row has candidates whose indices are larger by
/// `columns`.
struct MapBlock {
  int candidate;
  int columns;
  bool mirrored;
  std::size_t cell;
  int width;
  int rows;
  int count;
};

/// Layout of a map: which cell of the memory belongs to which candidate. A map is a sequence of strips, and a loop
/// updates whole strips. A strip is a sequence of tiles, one tile per panel of columns.
class Tiling {
 public:
  /// Returns the layout for candidates at any positions. Each strip is one tile of kBlock consecutive candidates.
  static Tiling blocks(int candidates);
  /// Returns the layout for a product grid. Each strip has loops::kStripRows rows of the grid and the tiles of
  /// loops::StripProduct.
  static Tiling grid(const CandidateGrid& candidates);
  /// Returns the layout for a product grid with the tiles of loops::MirroredProduct. A tile has columns in the left
  /// half of the grid, and mirror images of these columns in the right half.
  static Tiling mirrored_grid(const CandidateGrid& candidates);

  int strips() const { return strips_; }
  /// Return the number of cells in a strip and in a map, padding included.
  std::size_t strip_size() const { return strip_size_; }
  std::size_t size() const { return strip_size_ * static_cast<std::size_t>(strips_); }

  /// Returns the offset from a tile's cells to the cells of its mirror image; 0 without mirror images.
  std::ptrdiff_t mirror() const { return mirror_; }

  /// Calls visit(MapBlock) for the blocks of a strip.
  template <class Visit>
  void for_blocks(int strip, const Visit& visit) const {
    const int row = strip * rows_per_strip_;
    const int rows = std::min(rows_per_strip_, rows_ - row);
    for (int first = 0; first < padded_; first += width_) {
      const int width = std::min(width_, padded_ - first);
      const int columns = std::min(width, tiled_columns_ - first);
      const std::size_t cell =
          static_cast<std::size_t>(strip) * strip_size_ + static_cast<std::size_t>(first * rows_per_strip_);
      const int candidate = row * columns_ + first;
      visit(MapBlock{candidate, columns_, false, cell, width, rows, std::min(columns, candidates_ - candidate)});
      if (mirror_ == 0) continue;
      // A middle column is its own mirror image. It is part of the block above, so it is left out here.
      const int images = std::min(columns, columns_ - tiled_columns_ - first);
      visit(MapBlock{(row + 1) * columns_ - 1 - first, columns_, true, cell + static_cast<std::size_t>(mirror_), width,
                     rows, images});
    }
  }

 private:
  /// Divides this many columns into tiles.
  void tile(int columns);

  int candidates_ = 0;
  int columns_ = 0;        ///< columns of the grid; kBlock without a grid
  int tiled_columns_ = 0;  ///< columns that are not mirror images
  int rows_ = 0;
  int padded_ = 0;  ///< tiled columns with padding
  int width_ = 0;   ///< columns of a tile
  int rows_per_strip_ = 1;
  int strips_ = 0;
  std::size_t strip_size_ = 0;
  std::ptrdiff_t mirror_ = 0;
};

/// The maps of the means and of the variance, in standardised units (signal 1).
class MapTiles {
 public:
  MapTiles(const Tiling& tiling, const std::shared_ptr<Workers>& workers);

  /// Sets `means` maps of means to 0, and the variance to `prior`: one value per candidate, or a single value if all
  /// are equal.
  void restart(int means, const VectorView& prior);

  /// Returns the value to pass as `update` to a function of vector_loops.hpp that updates strips from the index `strip`
  /// on. `coefficients`: one coefficient per mean.
  loops::Update update(int strip, const double* coefficients);

  /// Copy the mean k, or the variance, at all candidates to `out`, transformed by `reading`.
  void read_mean(int k, const loops::MapTransform& reading, VectorOut out) const;
  void read_variance(const loops::MapTransform& reading, VectorOut out) const;

  const Tiling& tiling() const { return tiling_; }

 private:
  void read(const loops::AlignedArray& map, const loops::MapTransform& reading, double* out) const;

  Tiling tiling_;
  std::shared_ptr<Workers> workers_;
  int means_ = 0;
  std::array<loops::AlignedArray, loops::kMeans> mean_;
  loops::AlignedArray variance_;
};

}  // namespace palpate
