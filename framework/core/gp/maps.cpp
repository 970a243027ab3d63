// SPDX-License-Identifier: MIT
#include "gp/maps.hpp"

namespace palpate {

Tiling Tiling::pieces(int candidates) {
  Tiling out;
  out.candidates_ = candidates;
  out.columns_ = out.tiled_columns_ = out.padded_ = out.width_ = simd::kPiece;
  out.rows_ = out.strips_ = (candidates + simd::kPiece - 1) / simd::kPiece;
  out.strip_size_ = simd::kPiece;
  return out;
}

Tiling Tiling::grid(const Candidates& candidates) {
  Tiling out;
  out.candidates_ = candidates.size();
  out.columns_ = candidates.columns;
  out.rows_ = candidates.rows;
  out.rows_per_strip_ = simd::kStripRows;
  out.strips_ = (out.rows_ + simd::kStripRows - 1) / simd::kStripRows;
  out.tile(out.columns_);
  return out;
}

Tiling Tiling::mirrored_grid(const Candidates& candidates) {
  Tiling out = grid(candidates);
  out.tile((out.columns_ + 1) / 2);
  out.mirror_ = static_cast<std::ptrdiff_t>(out.strip_size_);
  out.strip_size_ *= 2;
  return out;
}

void Tiling::tile(int columns) {
  tiled_columns_ = columns;
  padded_ = simd::round_up(columns, simd::kLine);
  width_ = simd::kPanelLines * simd::kLine;
  tiles_per_strip_ = (padded_ + width_ - 1) / width_;
  strip_size_ = static_cast<std::size_t>(padded_) * simd::kStripRows;
}

Maps::Maps(const Tiling& tiling) : tiling_(tiling), variance_(tiling.size()) {}

void Maps::restart(int means, const VectorView& prior) {
  means_ = means;
  for (int k = 0; k < means; ++k) {
    simd::Lines& map = mean_[static_cast<std::size_t>(k)];
    if (map.size() == 0) map = simd::Lines(tiling_.size());
    std::fill_n(map.data(), map.size(), 0.0);
  }
  const bool same = prior.size() == 1;
  std::fill_n(variance_.data(), variance_.size(), 0.0);
  for (int tile = 0; tile < tiling_.tiles(); ++tile) {
    tiling_.for_runs(tile, [&](int candidate, int step, std::size_t cell, int count) {
      for (int i = 0; i < count; ++i)
        variance_.data()[cell + static_cast<std::size_t>(i)] = prior(same ? 0 : candidate + step * i);
    });
  }
}

simd::Update Maps::update(int strip, const double* coefficients) {
  const std::size_t first = static_cast<std::size_t>(strip) * tiling_.strip_size();
  simd::Update out{};
  out.means = means_;
  for (int k = 0; k < means_; ++k) {
    out.coefficient[k] = coefficients[k];
    out.mean[k] = mean_[static_cast<std::size_t>(k)].data() + first;
  }
  out.variance = variance_.data() + first;
  return out;
}

void Maps::read(const simd::Lines& map, VectorOut out) const {
  for (int tile = 0; tile < tiling_.tiles(); ++tile) {
    tiling_.for_runs(tile, [&](int candidate, int step, std::size_t cell, int count) {
      const double* const from = map.data() + cell;
      double* const to = &out(candidate);
      // A loop for each direction, as only steps that a compiler knows become moves of whole registers.
      if (step > 0) {
        for (int i = 0; i < count; ++i) to[i] = from[i];
      } else {
        for (int i = 0; i < count; ++i) to[-i] = from[i];
      }
    });
  }
}

// A view goes by value although it is written through. NOLINTNEXTLINE(performance-unnecessary-value-param)
void Maps::read_mean(int k, VectorOut out) const { read(mean_[static_cast<std::size_t>(k)], out); }

// NOLINTNEXTLINE(performance-unnecessary-value-param)
void Maps::read_variance(VectorOut out) const { read(variance_, out); }

}  // namespace palpate
