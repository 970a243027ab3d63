// SPDX-License-Identifier: MIT
#include "gp/vector_loops.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gp/vector_loops.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::loops::HWY_NAMESPACE {
namespace {

using namespace math::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace)
constexpr int kLineVectors = kLine / kLanes;

// Size of a tile whose sums are kept in registers. The sums of a tile, one row of B and one number of A fit into the 16
// or 32 registers.
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_NEON
constexpr int kTileRows = 8;
constexpr int kTileVectors = 3;
#elif HWY_TARGET == HWY_AVX2
constexpr int kTileRows = 4;
constexpr int kTileVectors = 3;
#else
constexpr int kTileRows = 4;
constexpr int kTileVectors = 2;
#endif

/// Computes a tile of kRows x kVectors registers of a product. The distance between rows of B is `b_stride`.
template <int kRows, int kVectors>
HWY_INLINE void accumulate(const double* a, const double* b, int b_stride, int depth, Vector (&sum)[kRows][kVectors]) {
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kVectors; ++j) sum[i][j] = hn::Zero(kReals);
  }
  for (int k = 0; k < depth; ++k, a += kStripRows, b += b_stride) {
    Vector row[kVectors];
#pragma GCC unroll 8
    for (int j = 0; j < kVectors; ++j) row[j] = at(b + j * kLanes);
#pragma GCC unroll 8
    for (int i = 0; i < kRows; ++i) {
      const Vector own = all(a[i]);
#pragma GCC unroll 8
      for (int j = 0; j < kVectors; ++j) sum[i][j] = hn::MulAdd(own, row[j], sum[i][j]);
    }
  }
}

/// Receives a tile of registers and stores it. `cell`: first cell of the tile; `width`: distance between its rows.
struct StoreSink {
  double* c;
  template <int kRows, int kVectors>
  HWY_INLINE void take(const Vector (&v)[kRows][kVectors], std::ptrdiff_t cell, int width) const {
#pragma GCC unroll 8
    for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 8
      for (int j = 0; j < kVectors; ++j) put(v[i][j], c + cell + i * width + j * kLanes);
    }
  }
};

/// Receives a tile of v and updates the maps.
struct AbsorbSink {
  const Update update;  ///< a copy, so that the compiler need not load its members again after each store

  template <int kRows, int kVectors>
  HWY_INLINE void take(const Vector (&v)[kRows][kVectors], std::ptrdiff_t cell, int width) const {
    for (int k = 0; k < update.means; ++k) {
      const Vector coefficient = all(update.coefficient[k]);
#pragma GCC unroll 24
      for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 24
        for (int j = 0; j < kVectors; ++j) {
          double* const mean = update.mean[k] + cell + i * width + j * kLanes;
          put(hn::MulAdd(coefficient, v[i][j], at(mean)), mean);
        }
      }
    }
#pragma GCC unroll 24
    for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 24
      for (int j = 0; j < kVectors; ++j) {
        double* const variance = update.variance + cell + i * width + j * kLanes;
        put(hn::NegMulAdd(v[i][j], v[i][j], at(variance)), variance);
      }
    }
  }
};

/// Returns the width of a tile of registers, in vectors, for rows of `all` vectors. The width divides `all`.
constexpr int vectors_of(int all) { return all % kTileVectors == 0 ? kTileVectors : (all % 2 == 0 ? 2 : 1); }

/// Tiles of a product, each computed as several tiles of registers.
struct PlainTiles {
  const StripProduct& product;
  std::ptrdiff_t strip_size() const { return static_cast<std::ptrdiff_t>(product.lines) * kLine * kStripRows; }

  template <int kLines, class Sink>
  HWY_INLINE void tile(const double* a, const double* b, std::ptrdiff_t cell, const Sink& sink) const {
    constexpr int kWidth = kLines * kLine;
    constexpr int kVectors = vectors_of(kLines * kLineVectors);
    for (int row = 0; row < kStripRows; row += kTileRows) {
      for (int first = 0; first < kWidth; first += kVectors * kLanes) {
        Vector sum[kTileRows][kVectors];
        accumulate<kTileRows, kVectors>(a + row, b + first, kWidth, product.depth, sum);
        sink.take(sum, cell + row * kWidth + first, kWidth);
      }
    }
  }
};

/// Tiles of a product with mirror images. A tile of registers has half as many rows as in PlainTiles, because each cell
/// needs registers for two sums: over the even and over the odd functions.
struct MirroredTiles {
  const MirroredProduct& whole;
  const StripProduct& product = whole.half;
  std::ptrdiff_t strip_size() const { return PlainTiles{product}.strip_size() + whole.mirror; }

  template <int kLines, class Sink>
  HWY_INLINE void tile(const double* a, const double* b, std::ptrdiff_t cell, const Sink& sink) const {
    constexpr int kWidth = kLines * kLine;
    constexpr int kVectors = vectors_of(kLines * kLineVectors);
    constexpr int kRows = kTileRows / 2;
    const std::ptrdiff_t even = whole.even;
    for (int row = 0; row < kStripRows; row += kRows) {
      for (int first = 0; first < kWidth; first += kVectors * kLanes) {
        Vector left[kRows][kVectors];
        Vector right[kRows][kVectors];
        accumulate<kRows, kVectors>(a + row, b + first, kWidth, whole.even, left);
        accumulate<kRows, kVectors>(a + row + even * kStripRows, b + first + even * kWidth, kWidth,
                                    product.depth - whole.even, right);
#pragma GCC unroll 8
        for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 8
          for (int j = 0; j < kVectors; ++j) {
            const Vector difference = hn::Sub(left[i][j], right[i][j]);
            left[i][j] = hn::Add(left[i][j], right[i][j]);
            right[i][j] = difference;
          }
        }
        const std::ptrdiff_t corner = cell + row * kWidth + first;
        sink.take(left, corner, kWidth);
        sink.take(right, corner + whole.mirror, kWidth);
      }
    }
  }
};

/// Computes all tiles panel by panel. In this order, B is read only once, and only the smaller matrix A is read for
/// every panel.
template <class Tiles, class Sink>
HWY_INLINE void strips(const Tiles& tiles, const Sink& sink) {
  const StripProduct& product = tiles.product;
  const int panels = (product.lines + kPanelLines - 1) / kPanelLines;
  const double* b = product.b;
  for (int panel = 0; panel < panels; ++panel) {
    const double* a = product.a;
    std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(panel) * kStripRows * kPanelLines * kLine;
    for (int strip = 0; strip < product.strips; ++strip) {
      switch (product.lines - panel * kPanelLines) {
        case 1:
          tiles.template tile<1>(a, b, cell, sink);
          break;
        case 2:
          tiles.template tile<2>(a, b, cell, sink);
          break;
        default:
          tiles.template tile<3>(a, b, cell, sink);
      }
      a += product.a_stride;
      cell += tiles.strip_size();
    }
    b += product.panel_stride;
  }
}

void multiply(const StripProduct& product, double* c) { strips(PlainTiles{product}, StoreSink{c}); }

void absorb_product(const StripProduct& product, const Update& update) {
  strips(PlainTiles{product}, AbsorbSink{update});
}

void absorb_mirrored(const MirroredProduct& product, const Update& update) {
  strips(MirroredTiles{product}, AbsorbSink{update});
}

void absorb_dense(const DenseRow& row, const Update& update) {
  constexpr int kTogether = kTileRows * kTileVectors;
  double* const v = row.rows + static_cast<std::ptrdiff_t>(row.depth) * kBlock;
  const AbsorbSink sink{update};
  const Vector share = all(1.0 / row.pivot);
  for (int cell = 0; cell < kBlock; cell += kTogether * kLanes) {
    Vector left[1][kTogether];
#pragma GCC unroll 24
    for (int j = 0; j < kTogether; ++j) left[0][j] = at(row.covariance + cell + j * kLanes);
    const double* earlier = row.rows + cell;
    for (int k = 0; k < row.depth; ++k, earlier += kBlock) {
      const Vector factor = all(row.factor[k]);
#pragma GCC unroll 24
      for (int j = 0; j < kTogether; ++j) left[0][j] = hn::NegMulAdd(factor, at(earlier + j * kLanes), left[0][j]);
    }
#pragma GCC unroll 24
    for (int j = 0; j < kTogether; ++j) {
      left[0][j] = hn::Mul(left[0][j], share);
      put(left[0][j], v + cell + j * kLanes);
    }
    sink.take(left, cell, 0);
  }
}

/// Copies rows of cells. Source rows are padded to cache lines, but destination rows are not. The last vector of a row
/// may therefore overlap the previous vector.
template <bool kMirrored>
HWY_INLINE void read_rows(const CellCopy& cells, const MapTransform& reading) {
  const Vector least = all(reading.least);
  const Vector most = all(reading.most);
  const Vector scale = all(reading.scale);
  const Vector offset = all(reading.offset);
  const auto read_at = [=](const double* from) {
    Vector cell = hn::LoadU(kReals, from);
    cell = hn::IfThenElse(hn::Lt(cell, least), least, cell);
    cell = hn::IfThenElse(hn::Lt(most, cell), most, cell);
    return hn::Add(hn::Mul(cell, scale), offset);
  };
  const int count = cells.count;
  const double* from = cells.from;
  double* to = cells.to;
  for (int row = 0; row < cells.rows; ++row, from += cells.width, to += cells.columns) {
    if (count < kLanes) {
      HWY_ALIGN double few[kLanes];
      put(read_at(from), few);
      for (int i = 0; i < count; ++i) to[kMirrored ? -i : i] = few[i];
      continue;
    }
    const auto copy = [&](int i) {
      if (kMirrored) {
        hn::StoreU(hn::Reverse(kReals, read_at(from + i)), kReals, to - i - (kLanes - 1));
      } else {
        hn::StoreU(read_at(from + i), kReals, to + i);
      }
    };
    for (int i = 0; i < count - kLanes; i += kLanes) copy(i);
    copy(count - kLanes);
  }
}

void read(const CellCopy& cells, const MapTransform& reading) {
  cells.mirrored ? read_rows<true>(cells, reading) : read_rows<false>(cells, reading);
}

// Number of rows in a block of a packed triangle. All rows of a block have the same padded length: `before` numbers in
// the columns of earlier blocks, then one row of the block's own triangle.
constexpr int kTriangleBlock = kLine;

void solve_lower(const double* lower, int n, double* x) {
  constexpr int kRows = 2;  // rows that are summed together
  for (int before = 0; before < n; before += kTriangleBlock) {
    const int rows = std::min(n - before, kTriangleBlock);
    const int length = before + kTriangleBlock;
    double known[kTriangleBlock] = {};  // per row: the sum over the columns of earlier blocks
    for (int first = 0; first < rows; first += kRows) {
      Vector sum[kRows][kLineVectors];
      for (auto& of_row : sum) std::fill_n(of_row, kLineVectors, hn::Zero(kReals));
      const double* const row = lower + static_cast<std::ptrdiff_t>(first) * length;
      for (int k = 0; k < before; k += kLine) {
#pragma GCC unroll 8
        for (int j = 0; j < kLineVectors; ++j) {
          const Vector values = at(x + k + j * kLanes);
#pragma GCC unroll 8
          for (int r = 0; r < kRows; ++r)
            sum[r][j] = hn::MulAdd(at(row + r * length + k + j * kLanes), values, sum[r][j]);
        }
      }
      for (int r = 0; r < kRows; ++r) {
        HWY_ALIGN double parts[kLine];
        for (int j = 0; j < kLineVectors; ++j) put(sum[r][j], parts + j * kLanes);
        for (const double part : parts) known[first + r] += part;
      }
    }
    for (int r = 0; r < rows; ++r) {
      const double* own = lower + r * length + before;
      double value = x[before + r] - known[r];
      for (int k = 0; k < r; ++k) value -= own[k] * x[before + k];
      x[before + r] = value / own[r];
    }
    lower += static_cast<std::ptrdiff_t>(kTriangleBlock) * length;
  }
}

void solve_lower_transposed(const double* lower, int n, double* x) {
  const int blocks = (n + kTriangleBlock - 1) / kTriangleBlock;
  lower += static_cast<std::ptrdiff_t>(kTriangleBlock) * kTriangleBlock * blocks * (blocks + 1) / 2;
  for (int before = (blocks - 1) * kTriangleBlock; before >= 0; before -= kTriangleBlock) {
    const int rows = std::min(n - before, kTriangleBlock);
    const int length = before + kTriangleBlock;
    lower -= static_cast<std::ptrdiff_t>(kTriangleBlock) * length;
    double own[kTriangleBlock] = {};
    for (int r = rows - 1; r >= 0; --r) {
      const double* const diagonal = lower + r * length + before;
      own[r] = x[before + r] / diagonal[r];
      for (int k = 0; k < r; ++k) x[before + k] -= diagonal[k] * own[r];
      x[before + r] = own[r];
    }
    for (int k = 0; k < before; k += kLanes) {
      Vector value = at(x + k);
#pragma GCC unroll 8
      for (int r = 0; r < kTriangleBlock; ++r) {
        if (r < rows) value = hn::NegMulAdd(all(own[r]), at(lower + r * length + k), value);
      }
      put(value, x + k);
    }
  }
}

void highest(const double* from, int count, double* out) {
  // Number of vectors of maxima that are updated in turn. A single vector would be slower, because each update waits
  // for the previous update of the same vector.
  constexpr int kTogether = std::min(kScores / kLanes, 8);
  for (int i = 0; i < count; ++i, from += kScores) {
    Vector most[kTogether];
#pragma GCC unroll 8
    for (int j = 0; j < kTogether; ++j) most[j] = hn::LoadU(kReals, from + j * kLanes);
    for (int first = kTogether * kLanes; first < kScores; first += kTogether * kLanes) {
#pragma GCC unroll 8
      for (int j = 0; j < kTogether; ++j) most[j] = hn::Max(most[j], hn::LoadU(kReals, from + first + j * kLanes));
    }
#pragma GCC unroll 8
    for (int j = 1; j < kTogether; ++j) most[0] = hn::Max(most[0], most[j]);
    out[i] = hn::GetLane(hn::MaxOfLanes(kReals, most[0]));
  }
}

}  // namespace
}  // namespace palpate::loops::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::loops {

void multiply(const StripProduct& product, double* c) { PALPATE_DISPATCH(multiply)(product, c); }

void absorb_product(const StripProduct& product, const Update& update) {
  PALPATE_DISPATCH(absorb_product)(product, update);
}

void absorb_mirrored(const MirroredProduct& product, const Update& update) {
  PALPATE_DISPATCH(absorb_mirrored)(product, update);
}

void absorb_dense(const DenseRow& row, const Update& update) { PALPATE_DISPATCH(absorb_dense)(row, update); }

void read(const CellCopy& cells, const MapTransform& reading) { PALPATE_DISPATCH(read)(cells, reading); }

void highest(const double* from, int count, double* out) { PALPATE_DISPATCH(highest)(from, count, out); }

void solve_lower(const double* lower, int n, double* x) { PALPATE_DISPATCH(solve_lower)(lower, n, x); }

void solve_lower_transposed(const double* lower, int n, double* x) {
  PALPATE_DISPATCH(solve_lower_transposed)(lower, n, x);
}

std::size_t packed_row(int i) {
  const auto line = static_cast<std::size_t>(kLine);
  const std::size_t block = static_cast<std::size_t>(i) / line;
  const std::size_t row = static_cast<std::size_t>(i) % line;
  // The rows of the blocks 0, 1, ... have 1, 2, ... cache lines.
  return line * (line * block * (block + 1) / 2 + row * (block + 1));
}

}  // namespace palpate::loops
#endif
