// SPDX-License-Identifier: MIT
// The maps of a posterior over the candidates, laid out for the loops that update them, and read in the order of the
// candidates.
#pragma once

#include "gp/candidates.hpp"
#include "gp/panels.hpp"
#include "gp/workers.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

namespace palpate {

/// Where the candidates lie in a map. A map is a sequence of strips, which are what one call updates; a strip is
/// a sequence of tiles, one a panel of the columns.
class Tiling {
 public:
  /// Any places: strips of one tile of loops::kBlock candidates one after the other.
  static Tiling blocks(int candidates);
  /// A product grid: strips of loops::kStripRows rows, cut into tiles as loops::Product has them.
  static Tiling grid(const Candidates& candidates);
  /// The same as loops::MirroredProduct has them: a tile holds some columns of the left half of the grid and their
  /// mirror images in the right half.
  static Tiling mirrored_grid(const Candidates& candidates);

  int strips() const { return strips_; }
  /// Cells in a strip and in all, padding included.
  std::size_t strip_size() const { return strip_size_; }
  std::size_t size() const { return strip_size_ * static_cast<std::size_t>(strips_); }

  /// From the cells of a tile to those of its mirror image; 0 if there is none.
  std::ptrdiff_t mirror() const { return mirror_; }

  /// Part of a tile: rows of `count` cells, `width` apart from `cell` on, in which the candidates candidate,
  /// candidate + 1, ... lie, of mirror images candidate, candidate - 1, ...; each row begins `columns` candidates after
  /// the one before.
  struct Block {
    int candidate;
    int columns;
    bool mirrored;
    std::size_t cell;
    int width;
    int rows;
    int count;
  };
  /// Calls visit(block) for the blocks of a strip.
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
      visit(Block{candidate, columns_, false, cell, width, rows, std::min(columns, candidates_ - candidate)});
      if (mirror_ == 0) continue;
      // A column in the middle is its own image and was visited.
      const int images = std::min(columns, columns_ - tiled_columns_ - first);
      visit(Block{(row + 1) * columns_ - 1 - first, columns_, true, cell + static_cast<std::size_t>(mirror_), width,
                  rows, images});
    }
  }

 private:
  /// Cuts that many columns into tiles.
  void tile(int columns);

  int candidates_ = 0;
  int columns_ = 0;        ///< of the grid; of any places, those of a piece
  int tiled_columns_ = 0;  ///< those that are no mirror images
  int rows_ = 0;
  int padded_ = 0;  ///< tiled columns with padding
  int width_ = 0;   ///< of a tile, in columns
  int rows_per_strip_ = 1;
  int strips_ = 0;
  std::size_t strip_size_ = 0;
  std::ptrdiff_t mirror_ = 0;
};

/// Maps of means and of the variance as they stand, all in units of the prior.
class Maps {
 public:
  Maps(const Tiling& tiling, const std::shared_ptr<Workers>& workers);

  /// Back to the prior: `means` maps of 0, and the variance, one number if it is the same at all candidates.
  void restart(int means, const VectorView& prior);

  /// What the loops need to take a row with such coefficients into the cells of a strip.
  loops::Update update(int strip, const double* coefficients);

  /// The mean number k, and the variance, at all candidates, each number as `reading` has it.
  void read_mean(int k, const loops::Reading& reading, VectorOut out) const;
  void read_variance(const loops::Reading& reading, VectorOut out) const;

  const Tiling& tiling() const { return tiling_; }

 private:
  void read(const loops::Lines& map, const loops::Reading& reading, double* out) const;

  Tiling tiling_;
  std::shared_ptr<Workers> workers_;
  int means_ = 0;
  std::array<loops::Lines, loops::kMeans> mean_;
  loops::Lines variance_;
};

}  // namespace palpate
