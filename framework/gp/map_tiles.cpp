// SPDX-License-Identifier: MIT
#include "gp/map_tiles.hpp"

namespace palpate {

Tiling Tiling::blocks(int candidates) {
  Tiling out;
  out.candidates_ = candidates;
  out.columns_ = out.tiled_columns_ = out.padded_ = out.width_ = loops::kBlock;
  out.rows_ = out.strips_ = (candidates + loops::kBlock - 1) / loops::kBlock;
  out.strip_size_ = loops::kBlock;
  return out;
}

Tiling Tiling::grid(const CandidateGrid& candidates) {
  Tiling out;
  out.candidates_ = candidates.size();
  out.columns_ = candidates.columns;
  out.rows_ = candidates.rows;
  out.rows_per_strip_ = loops::kStripRows;
  out.strips_ = (out.rows_ + loops::kStripRows - 1) / loops::kStripRows;
  out.tile(out.columns_);
  return out;
}

Tiling Tiling::mirrored_grid(const CandidateGrid& candidates) {
  Tiling out = grid(candidates);
  out.tile((out.columns_ + 1) / 2);
  out.mirror_ = static_cast<std::ptrdiff_t>(out.strip_size_);
  out.strip_size_ *= 2;
  return out;
}

void Tiling::tile(int columns) {
  tiled_columns_ = columns;
  padded_ = loops::round_up(columns, loops::kLine);
  width_ = loops::kPanelLines * loops::kLine;
  strip_size_ = static_cast<std::size_t>(padded_) * loops::kStripRows;
}

MapTiles::MapTiles(const Tiling& tiling, const std::shared_ptr<Workers>& workers)
    : tiling_(tiling), workers_(workers), variance_(tiling.size()) {}

void MapTiles::restart(int means, const VectorView& prior) {
  means_ = means;
  for (int k = 0; k < means; ++k) {
    loops::AlignedArray& map = mean_[static_cast<std::size_t>(k)];
    if (map.size() == 0) map = loops::AlignedArray(tiling_.size());
    std::fill_n(map.data(), map.size(), 0.0);
  }
  std::fill_n(variance_.data(), variance_.size(), 0.0);
  for (int strip = 0; strip < tiling_.strips(); ++strip) {
    tiling_.for_blocks(strip, [&](const MapBlock& block) {
      for (int row = 0; row < block.rows; ++row) {
        double* const to = variance_.data() + block.cell + static_cast<std::ptrdiff_t>(row) * block.width;
        if (prior.size() == 1) {
          std::fill_n(to, block.count, prior(0));
          continue;
        }
        const int first = block.candidate + row * block.columns;
        for (int i = 0; i < block.count; ++i) to[i] = prior(first + (block.mirrored ? -i : i));
      }
    });
  }
}

loops::Update MapTiles::update(int strip, const double* coefficients) {
  const std::size_t first = static_cast<std::size_t>(strip) * tiling_.strip_size();
  loops::Update out{};
  out.means = means_;
  for (int k = 0; k < means_; ++k) {
    out.coefficient[k] = coefficients[k];
    out.mean[k] = mean_[static_cast<std::size_t>(k)].data() + first;
  }
  out.variance = variance_.data() + first;
  return out;
}

void MapTiles::read(const loops::AlignedArray& map, const loops::MapTransform& reading, double* out) const {
  workers_->for_each(tiling_.strips(), [&](int strip, int) {
    tiling_.for_blocks(strip, [&](const MapBlock& block) {
      loops::read({map.data() + block.cell, block.width, out + block.candidate, block.columns, block.rows, block.count,
                   block.mirrored},
                  reading);
    });
  });
}

// `out` is a view (Eigen::Ref), so it is passed by value, although the function writes to its data.
// NOLINTNEXTLINE(performance-unnecessary-value-param)
void MapTiles::read_mean(int k, const loops::MapTransform& reading, VectorOut out) const {
  read(mean_[static_cast<std::size_t>(k)], reading, out.data());
}

// NOLINTNEXTLINE(performance-unnecessary-value-param)
void MapTiles::read_variance(const loops::MapTransform& reading, VectorOut out) const {
  read(variance_, reading, out.data());
}

}  // namespace palpate
