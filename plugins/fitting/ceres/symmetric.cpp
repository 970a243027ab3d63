// SPDX-License-Identifier: MIT
#include "symmetric.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::fitting {
namespace {

using Eigen::Index;

/// Columns that are taken into the rest of a matrix together, in strips: so much of a few strips stays in the first
/// cache.
constexpr Index kPanel = 8;

PALPATE_INLINE Index least(Index a, Index b) { return a < b ? a : b; }

struct Loops {
  bool (*factorise)(Strips& matrix, double* reciprocals);
  void (*invert_transposed)(const Strips& factor, const double* reciprocals, Strips& out);
  void (*square_upper)(const Strips& upper, Strips& out);
  void (*times)(const Strips& matrix, Index s, Index from, Index to, const double* b, double* out);
};

#define PALPATE_SET sse2
#define PALPATE_TARGET
#define PALPATE_LANES 2
#define PALPATE_PACKS 2
#define PALPATE_COLUMNS 4
#include "loops.inc"

#define PALPATE_SET avx2
#define PALPATE_TARGET PALPATE_AVX2
#define PALPATE_LANES 4
#define PALPATE_PACKS 2
#define PALPATE_COLUMNS 4
#include "loops.inc"

#define PALPATE_SET avx512
#define PALPATE_TARGET PALPATE_AVX512
#define PALPATE_LANES 8
#define PALPATE_PACKS 3
#define PALPATE_COLUMNS 8
#include "loops.inc"

const Loops& loops_of(simd::Lanes lanes) {
  if (lanes == simd::Lanes::avx512) return avx512::kLoops;
  return lanes == simd::Lanes::avx2 ? avx2::kLoops : sse2::kLoops;
}

}  // namespace

void Strips::put(Index j, const Eigen::VectorXd& values) {
  const double* from = values.data();
  const Index first = j / 8;
  const Index whole = size_ / 8;
  for (Index s = first; s < whole; ++s, from += 8) std::copy_n(from, 8, at(s, j)->numbers);
  if (whole < strips_) {
    double* const last = at(whole, j)->numbers;
    std::fill(std::copy_n(from, size_ % 8, last), last + 8, 0.0);
  }
}

Eigen::MatrixXd Strips::mirrored() const {
  Eigen::MatrixXd out(size_, size_);
  for (Index j = 0; j < size_; ++j) {
    for (Index i = j; i < size_; ++i) out(i, j) = out(j, i) = (*this)(i, j);
  }
  return out;
}

// Panel by panel: what earlier panels have taken from a column is done when its panel comes, so that within a panel
// each column of tiles waits only for those before it in the panel.
bool factorise(simd::Lanes lanes, Strips& matrix, std::vector<double>& reciprocals) {
  const Index strips = matrix.strips();
  const Index n = matrix.size();
  for (Index j = 0; j < 8 * strips && n % 8 > 0; ++j) {
    double* const line = matrix.at(strips - 1, j)->numbers;
    std::fill(j < n ? line + n % 8 : line, line + 8, 0.0);
    if (j >= n) line[j % 8] = 1.0;
  }
  reciprocals.resize(static_cast<std::size_t>(8 * strips));
  return loops_of(lanes).factorise(matrix, reciprocals.data()) &&
         std::all_of(reciprocals.begin(), reciprocals.end(), [](double one) { return one > 0.0; });
}

void solve_lower(simd::Lanes lanes, const Strips& factor, VectorOut b) {
  const Loops& loops = loops_of(lanes);
  for (Index s = 0; s < factor.strips(); ++s) {
    Line sum{};
    loops.times(factor, s, 0, 8 * s, b.data(), sum.numbers);
    for (Index r = 0; r < std::min<Index>(8, factor.size() - 8 * s); ++r) {
      double& own = b(8 * s + r);
      own -= sum.numbers[r];
      for (Index c = 0; c < r; ++c) own -= factor.at(s, 8 * s + c)->numbers[r] * b(8 * s + c);
      own /= factor.at(s, 8 * s + r)->numbers[r];
    }
  }
}

void invert_transposed(simd::Lanes lanes, const Strips& factor, const std::vector<double>& reciprocals, Strips& out) {
  const Index strips = factor.strips();
  for (Index s = 0; s < strips; ++s) {
    std::fill(out.at(s, 0), out.at(s, 0) + 8 * strips, Line{});
    for (Index r = 0; r < 8; ++r) out.at(s, 8 * s + r)->numbers[r] = 1.0;
  }
  loops_of(lanes).invert_transposed(factor, reciprocals.data(), out);
}

void multiply_upper(simd::Lanes lanes, const Strips& upper, VectorOut b) {
  const Loops& loops = loops_of(lanes);
  for (Index s = 0; s < upper.strips(); ++s) {
    Line sum{};
    loops.times(upper, s, 8 * s, upper.size(), b.data(), sum.numbers);
    std::copy_n(sum.numbers, std::min<Index>(8, upper.size() - 8 * s), b.data() + 8 * s);
  }
}

void square_upper(simd::Lanes lanes, const Strips& upper, Strips& out) {
  for (Index s = 0; s < upper.strips(); ++s) std::fill(out.at(s, 0), out.at(s, 0) + 8 * (s + 1), Line{});
  loops_of(lanes).square_upper(upper, out);
}

}  // namespace palpate::fitting
