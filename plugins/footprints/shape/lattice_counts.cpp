// SPDX-License-Identifier: MIT
#include "lattice_counts.hpp"

#include "clones.hpp"

namespace palpate::footprints {
namespace {

/// All bits from a column on, of a word that begins at column `first`. (Two shifts, as one by 64 is none.)
PALPATE_INLINE std::uint64_t from(int column, int first, std::uint64_t all) {
  const auto before = static_cast<std::uint64_t>(std::min(std::max(column - first, 0), 64));
  return all << (before >> 1U) << (before - (before >> 1U));
}

// Shifts of what is known beforehand would not become vectors: all bits are handed over.
PALPATE_CLONES void set_bits(const Cells& rows, const Ends& ends, int first, std::uint64_t all,
                             std::uint64_t* __restrict bits) {
  const int* const begins = ends.begins;
  const int* const behind = ends.ends;
  const int end = rows.end;
  for (int row = rows.begin; row < end; ++row)
    bits[row] |= from(begins[row], first, all) & ~from(behind[row], first, all);
}

/// Adds two numbers of one digit each to the sum, and leaves what is carried in the first of them.
PALPATE_CLONES void add_both(std::size_t words, std::uint64_t* __restrict sum, std::uint64_t* __restrict one,
                             const std::uint64_t* __restrict other) {
  for (std::size_t i = 0; i < words; ++i) {
    const std::uint64_t differ = sum[i] ^ one[i];
    one[i] = (sum[i] & one[i]) | (differ & other[i]);
    sum[i] = differ ^ other[i];
  }
}

PALPATE_CLONES void add_digit(std::uint64_t bits, std::uint64_t digit, std::uint64_t* __restrict out) {
  for (std::uint64_t i = 0; i < 64; ++i) out[i] += (bits >> i & 1U) << digit;
}

}  // namespace

void BitCounts::add(const std::uint64_t* bits, std::size_t digit) {
  for (;; ++digit) {
    if (digit == digits_.size()) {
      if (std::all_of(bits, bits + words_, [](std::uint64_t word) { return word == 0; })) return;
      digits_.push_back({std::vector<std::uint64_t>(words_, 0), std::vector<std::uint64_t>(words_, 0)});
    }
    Digit& one = digits_[digit];
    one.waits = !one.waits;
    if (one.waits) {
      std::copy_n(bits, words_, one.waiting.begin());
      return;
    }
    add_both(words_, one.sum.data(), one.waiting.data(), bits);
    bits = one.waiting.data();
  }
}

void BitCounts::settle() {
  const std::vector<std::uint64_t> none(words_, 0);
  for (std::size_t digit = 0; digit < digits_.size(); ++digit) {
    if (digits_[digit].waits) add(none.data(), digit);
  }
}

void BitCounts::read(std::size_t word, std::uint64_t* out) const {
  std::fill_n(out, 64, 0);
  for (std::size_t digit = 0; digit < digits_.size(); ++digit) add_digit(digits_[digit].sum[word], digit, out);
}

void set_bits(const Cells& rows, const Ends& ends, int word, std::uint64_t* bits) {
  set_bits(rows, ends, word * 64, ~std::uint64_t{0}, bits);
}

// Written out for each family, so that the loops are without branches.
PALPATE_CLONES void Cuts::rows(int begin, int end, int columns, int* __restrict begins, int* __restrict ends) const {
  const Cuts by = *this;
  const double squared = by.reach_ * by.reach_;
  constexpr int kAtOnce = 64;
  double low[kAtOnce];
  double high[kAtOnce];
  for (int from = begin; from < end; from += kAtOnce) {
    const int count = std::min(kAtOnce, end - from);
    if (by.family_ == Form::Family::box) {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y_;
        const double first = by.slope_[0] * dy;
        const double second = by.slope_[1] * dy;
        low[i] = by.x_ + std::max(first - by.half_[0], second - by.half_[1]);
        high[i] = std::abs(dy) > by.reach_ ? -1.0 : by.x_ + std::min(first + by.half_[0], second + by.half_[1]);
      }
    } else {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y_;
        const double rest = 1.0 - dy * dy / squared;
        const double middle = by.x_ + by.slope_[0] * dy;
        const double half = by.half_[0] * std::sqrt(std::max(rest, 0.0));
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

}  // namespace palpate::footprints
