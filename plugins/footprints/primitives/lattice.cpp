// SPDX-License-Identifier: MIT
#include "lattice.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "primitives/lattice.cpp"
#include "math/highway.hpp"

// Compiled for each set of instructions, as a compiler makes vectors of it. Products are not fused with sums: what is
// computed is the same to the last bit.
HWY_BEFORE_NAMESPACE();
namespace palpate::footprints::HWY_NAMESPACE {
namespace {

/// All bits from a column on, of a word that begins at column `first`. (Two shifts, as one by 64 is none.)
HWY_INLINE std::uint64_t from(int column, int first, std::uint64_t all) {
  const auto before = static_cast<std::uint64_t>(std::min(std::max(column - first, 0), 64));
  return all << (before >> 1U) << (before - (before >> 1U));
}

// Shifts of what is known beforehand would not become vectors: all bits are handed over.
void set_word(const Cells& rows, const Ends& ends, int first, std::uint64_t all, std::uint64_t* __restrict bits) {
  const int* const begins = ends.begins;
  const int* const behind = ends.ends;
  const int end = rows.end;
  for (int row = rows.begin; row < end; ++row)
    bits[row] |= from(begins[row], first, all) & ~from(behind[row], first, all);
}

void fill_rows(int rows, std::size_t columns, std::size_t words, std::uint64_t* bits) {
  for (int row = 0; row < rows; ++row, bits += words * (columns + 1)) {
    for (std::size_t i = words; i < words * columns; ++i) bits[i] ^= bits[i - words];
  }
}

void count_bits(std::size_t places, std::size_t words, const std::uint64_t* bits, double* __restrict out) {
  for (std::size_t place = 0; place < places; ++place) {
    int count = 0;
    for (std::size_t word = 0; word < words; ++word) count += __builtin_popcountll(*bits++);
    out[place] = count;
  }
}

// Written out for each family, so that the loops are without branches.
void cut_rows(const Cuts& cuts, int begin, int end, int columns, int* __restrict begins, int* __restrict ends) {
  const Cuts by = cuts;
  const double squared = by.reach * by.reach;
  constexpr int kAtOnce = 64;
  double low[kAtOnce];
  double high[kAtOnce];
  for (int from = begin; from < end; from += kAtOnce) {
    const int count = std::min(kAtOnce, end - from);
    if (by.family == Form::Family::box) {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y;
        const double first = by.slope[0] * dy;
        const double second = by.slope[1] * dy;
        low[i] = by.x + std::max(first - by.half[0], second - by.half[1]);
        high[i] = std::abs(dy) > by.reach ? -1.0 : by.x + std::min(first + by.half[0], second + by.half[1]);
      }
    } else {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y;
        const double rest = 1.0 - dy * dy / squared;
        const double middle = by.x + by.slope[0] * dy;
        const double half = by.half[0] * std::sqrt(std::max(rest, 0.0));
        low[i] = middle - half;
        high[i] = rest < 0.0 ? -1.0 : middle + half;
      }
    }
    for (int i = 0; i < count; ++i) {
      // Rounded up, and no less than 0: without SSE4.1 std::ceil and std::floor are calls.
      const int whole = static_cast<int>(low[i]);
      begins[from + i] = std::max(whole + (low[i] > whole ? 1 : 0), 0);
    }
    for (int i = 0; i < count; ++i) {
      const int above = static_cast<int>(high[i] + 1.0);
      ends[from + i] = low[i] > high[i] ? 0 : std::min(above, columns);
    }
  }
}

}  // namespace
}  // namespace palpate::footprints::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::footprints {

void LatticeBits::fill() {
  PALPATE_DISPATCH(fill_rows)(lattice_.rows(), static_cast<std::size_t>(lattice_.columns()), words_, bits_.data());
}

void LatticeBits::count(VectorOut out) const {
  const auto columns = static_cast<std::size_t>(lattice_.columns());
  for (int row = 0; row < lattice_.rows(); ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * (columns + 1) * words_;
    PALPATE_DISPATCH(count_bits)
    (columns, words_, bits_.data() + first, out.data() + static_cast<std::ptrdiff_t>(row) * lattice_.columns());
  }
}

void set_bits(const Cells& rows, const Ends& ends, int word, std::uint64_t* bits) {
  PALPATE_DISPATCH(set_word)(rows, ends, word * 64, ~std::uint64_t{0}, bits);
}

void Cuts::rows(int begin, int end, int columns, int* begins, int* ends) const {
  PALPATE_DISPATCH(cut_rows)(*this, begin, end, columns, begins, ends);
}

}  // namespace palpate::footprints
#endif
