// SPDX-License-Identifier: MIT
#include "strip_matrix.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "strip_matrix.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::fitting::HWY_NAMESPACE {
namespace {

using Eigen::Index;
using namespace math::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace)

/// Number of strips in a panel. Eight columns of kPanel strips fit into the first-level cache.
constexpr Index kPanel = 8;

// One loop sums the products of kPacks vector registers of rows with kColumns columns. The kPacks * kColumns sums fill
// the vector registers of the processor.
#if HWY_TARGET == HWY_AVX3
constexpr Index kPacks = 3;
constexpr Index kColumns = 8;
#elif HWY_TARGET == HWY_NEON
constexpr Index kPacks = 4;
constexpr Index kColumns = 4;
#else
constexpr Index kPacks = 2;
constexpr Index kColumns = 4;
#endif

/// Number of vector registers per line, and number of strips whose tiles are multiplied in one loop.
constexpr Index kPacksOfLine = 8 / kLanes;
constexpr Index kTogether = kPacks > kPacksOfLine ? kPacks / kPacksOfLine : 1;

/// Computes out_p += a_p * b^T (or -=) for kCount vector registers of rows. `a` and `b` have `depth` columns. `out` has
/// eight columns.
template <Index kCount, bool kPlus>
HWY_INLINE void multiply(const double* const* a, const double* b, Index depth, double* const* out) {
  for (Index first = 0; first < 8; first += kColumns) {
    Vector sum[kCount][kColumns];
    for (auto& row : sum) std::fill_n(row, kColumns, hn::Zero(kReals));
    for (Index k = 0; k < depth; ++k) {
      Vector column[kCount];
#pragma GCC unroll 8
      for (Index p = 0; p < kCount; ++p) column[p] = at(a[p] + 8 * k);
#pragma GCC unroll 8
      for (Index j = 0; j < kColumns; ++j) {
        const Vector factor = all(b[8 * k + first + j]);
#pragma GCC unroll 8
        for (Index p = 0; p < kCount; ++p) sum[p][j] = hn::MulAdd(column[p], factor, sum[p][j]);
      }
    }
#pragma GCC unroll 8
    for (Index p = 0; p < kCount; ++p) {
#pragma GCC unroll 8
      for (Index j = 0; j < kColumns; ++j) {
        double* const place = out[p] + 8 * (first + j);
        put(kPlus ? hn::Add(at(place), sum[p][j]) : hn::Sub(at(place), sum[p][j]), place);
      }
    }
  }
}

/// Adds (or subtracts) the products A_s * B_j^T to the tiles (s, j) of C, for strips s in [first, last). A product is
/// over the columns [from, to) of A and B.
template <bool kPlus>
HWY_INLINE void update(StripMatrix& c, const StripMatrix& a, const StripMatrix& b, Index first, Index last, Index j,
                       Index from, Index to) {
  const double* in[kPacks];
  double* out[kPacks];
  Index packs = 0;
  for (Index s = first; s < last; ++s) {
    for (Index row = 0; row < 8; row += kLanes) {
      in[packs] = a.at(s, from)->numbers + row;
      out[packs] = c.at(s, 8 * j)->numbers + row;
      if (++packs < kPacks) continue;
      multiply<kPacks, kPlus>(in, b.at(j, from)->numbers, to - from, out);
      packs = 0;
    }
  }
  for (Index p = 0; p < packs; ++p) multiply<1, kPlus>(in + p, b.at(j, from)->numbers, to - from, out + p);
}

/// Factorises a tile into its triangle L and computes the reciprocals of the diagonal. Returns false if it is not
/// positive definite.
HWY_INLINE bool factorise_tile(double* tile, double* reciprocals) {
  for (Index c = 0; c < 8; ++c) {
    double* const own = tile + 8 * c;
    // The rows above the diagonal are also computed, because this needs no additional time.
    for (Index d = 0; d < c; ++d) {
      const Vector share = all(tile[8 * d + c]);
#pragma GCC unroll 8
      for (Index row = 0; row < 8; row += kLanes)
        put(hn::NegMulAdd(share, at(tile + 8 * d + row), at(own + row)), own + row);
    }
    if (!(own[c] > 0.0)) return false;
    const double root = std::sqrt(own[c]);
    reciprocals[c] = 1.0 / root;
#pragma GCC unroll 8
    for (Index row = 0; row < 8; row += kLanes) put(hn::Mul(at(own + row), all(reciprocals[c])), own + row);
    own[c] = root;
  }
  return true;
}

/// Computes X * L^-T in place, where X is a tile and L is the triangle of a diagonal tile.
HWY_INLINE void solve_tile(double* x, const double* lower, const double* reciprocals) {
#pragma GCC unroll 8
  for (Index row = 0; row < 8; row += kLanes) {
    Vector columns[8];
#pragma GCC unroll 8
    for (Index c = 0; c < 8; ++c) {
      Vector value = at(x + 8 * c + row);
#pragma GCC unroll 8
      for (Index d = 0; d < 8; ++d) {
        if (d < c) value = hn::NegMulAdd(columns[d], all(lower[8 * d + c]), value);
      }
      columns[c] = hn::Mul(value, all(reciprocals[c]));
      put(columns[c], x + 8 * c + row);
    }
  }
}

// The matrix is factorised panel by panel. The contributions of all earlier panels are complete when a panel starts.
// Within a panel, each column of tiles therefore depends only on columns of this panel.
bool factorise(StripMatrix& matrix, double* reciprocals) {
  const Index strips = matrix.strips();
  for (Index panel = 0; panel < strips; panel += kPanel) {
    const Index end = std::min(panel + kPanel, strips);
    for (Index j = panel; j < end; ++j) {
      if (j > panel) update<false>(matrix, matrix, matrix, j, strips, j, 8 * panel, 8 * j);
      const double* const own = matrix.at(j, 8 * j)->numbers;
      if (!factorise_tile(matrix.at(j, 8 * j)->numbers, reciprocals + 8 * j)) return false;
      for (Index s = j + 1; s < strips; ++s) solve_tile(matrix.at(s, 8 * j)->numbers, own, reciprocals + 8 * j);
    }
    for (Index s = end; s < strips; s += kTogether) {
      const Index last = std::min(s + kTogether, strips);
      for (Index j = end; j < last; ++j)
        update<false>(matrix, matrix, matrix, j > s ? j : s, last, j, 8 * panel, 8 * end);
    }
  }
  return true;
}

// L^-T is computed by applying the factorisation of K to rows of the identity that are added below K.
void invert_transposed(const StripMatrix& factor, const double* reciprocals, StripMatrix& out) {
  const Index strips = factor.strips();
  for (Index panel = 0; panel < strips; panel += kPanel) {
    const Index end = std::min(panel + kPanel, strips);
    for (Index j = panel; j < end; ++j) {
      if (j > panel) update<false>(out, out, factor, 0, j, j, 8 * panel, 8 * j);
      const double* const own = factor.at(j, 8 * j)->numbers;
      for (Index s = 0; s <= j; ++s) solve_tile(out.at(s, 8 * j)->numbers, own, reciprocals + 8 * j);
    }
    for (Index s = 0; s < end; s += kTogether) {
      for (Index j = end; j < strips; ++j)
        update<false>(out, out, factor, s, std::min(s + kTogether, end), j, 8 * panel, 8 * end);
    }
  }
}

void square_upper(const StripMatrix& upper, StripMatrix& out) {
  const Index strips = upper.strips();
  for (Index panel = 0; panel < strips; panel += kPanel) {
    const Index end = std::min(panel + kPanel, strips);
    for (Index s = 0; s < end; s += kTogether) {
      const Index last = std::min(s + kTogether, end);
      const Index from = panel > s ? panel : s;  // Columns to the left of this one are 0.
      for (Index j = 0; j < last; ++j) update<true>(out, upper, upper, j > s ? j : s, last, j, 8 * from, 8 * end);
    }
  }
}

/// Adds the product of columns [from, to) of strip `s` with b[from], b[from + 1], ... to the line `out`.
void times(const StripMatrix& matrix, Index s, Index from, Index to, const double* b, double* out) {
  for (Index p = 0; p < kPacksOfLine; ++p) {
    const auto column = [&](Index k) { return at(matrix.at(s, k)->numbers + p * kLanes); };
    Vector sum = at(out + p * kLanes);
    Vector odd = hn::Zero(kReals);  // With two sums, additions wait half as long for each other.
    Index k = from;
    for (; k + 1 < to; k += 2) {
      sum = hn::MulAdd(all(b[k]), column(k), sum);
      odd = hn::MulAdd(all(b[k + 1]), column(k + 1), odd);
    }
    if (k < to) sum = hn::MulAdd(all(b[k]), column(k), sum);
    put(hn::Add(sum, odd), out + p * kLanes);
  }
}

}  // namespace
}  // namespace palpate::fitting::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::fitting {

using Eigen::Index;

void StripMatrix::put(Index j, const Eigen::VectorXd& values) {
  const double* from = values.data();
  const Index first = j / 8;
  const Index whole = size_ / 8;
  for (Index s = first; s < whole; ++s, from += 8) std::copy_n(from, 8, at(s, j)->numbers);
  if (whole < strips_) {
    double* const last = at(whole, j)->numbers;
    std::fill(std::copy_n(from, size_ % 8, last), last + 8, 0.0);
  }
}

Eigen::MatrixXd StripMatrix::mirrored() const {
  Eigen::MatrixXd out(size_, size_);
  for (Index j = 0; j < size_; ++j) {
    for (Index i = j; i < size_; ++i) out(i, j) = out(j, i) = (*this)(i, j);
  }
  return out;
}

bool factorise(StripMatrix& matrix, std::vector<double>& reciprocals) {
  const Index strips = matrix.strips();
  const Index n = matrix.size();
  for (Index j = 0; j < 8 * strips && n % 8 > 0; ++j) {
    double* const line = matrix.at(strips - 1, j)->numbers;
    std::fill(j < n ? line + n % 8 : line, line + 8, 0.0);
    if (j >= n) line[j % 8] = 1.0;
  }
  reciprocals.resize(static_cast<std::size_t>(8 * strips));
  return PALPATE_DISPATCH(factorise)(matrix, reciprocals.data()) &&
         std::all_of(reciprocals.begin(), reciprocals.end(), [](double one) { return one > 0.0; });
}

void solve_lower(const StripMatrix& factor, VectorOut b) {
  for (Index s = 0; s < factor.strips(); ++s) {
    ColumnPack sum{};
    PALPATE_DISPATCH(times)(factor, s, 0, 8 * s, b.data(), sum.numbers);
    for (Index r = 0; r < std::min<Index>(8, factor.size() - 8 * s); ++r) {
      double& own = b(8 * s + r);
      own -= sum.numbers[r];
      for (Index c = 0; c < r; ++c) own -= factor.at(s, 8 * s + c)->numbers[r] * b(8 * s + c);
      own /= factor.at(s, 8 * s + r)->numbers[r];
    }
  }
}

void invert_transposed(const StripMatrix& factor, const std::vector<double>& reciprocals, StripMatrix& out) {
  const Index strips = factor.strips();
  for (Index s = 0; s < strips; ++s) {
    std::fill(out.at(s, 0), out.at(s, 0) + 8 * strips, ColumnPack{});
    for (Index r = 0; r < 8; ++r) out.at(s, 8 * s + r)->numbers[r] = 1.0;
  }
  PALPATE_DISPATCH(invert_transposed)(factor, reciprocals.data(), out);
}

void multiply_upper(const StripMatrix& upper, VectorOut b) {
  for (Index s = 0; s < upper.strips(); ++s) {
    ColumnPack sum{};
    PALPATE_DISPATCH(times)(upper, s, 8 * s, upper.size(), b.data(), sum.numbers);
    std::copy_n(sum.numbers, std::min<Index>(8, upper.size() - 8 * s), b.data() + 8 * s);
  }
}

void square_upper(const StripMatrix& upper, StripMatrix& out) {
  for (Index s = 0; s < upper.strips(); ++s) std::fill(out.at(s, 0), out.at(s, 0) + 8 * (s + 1), ColumnPack{});
  PALPATE_DISPATCH(square_upper)(upper, out);
}

}  // namespace palpate::fitting
#endif
