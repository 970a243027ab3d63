// SPDX-License-Identifier: MIT
#include "gp/simd/table.hpp"

#include <palpate/simd.hpp>

namespace palpate::simd {

const Table& table_of(Lanes lanes) {
  if (lanes == Lanes::avx512) return kAvx512;
  return lanes == Lanes::avx2 ? kAvx2 : kSse2;
}

bool runs(const Table& table) {
  return &table == &kSse2 || widest() == Lanes::avx512 || (&table == &kAvx2 && widest() == Lanes::avx2);
}

const Table& baseline() { return kSse2; }

const Table& fastest() { return table_of(widest()); }

std::size_t packed_row(int i) {
  const auto line = static_cast<std::size_t>(kLine);
  const std::size_t block = static_cast<std::size_t>(i) / line;
  const std::size_t row = static_cast<std::size_t>(i) % line;
  // The blocks before have 1, 2, ... lines a row.
  return line * (line * block * (block + 1) / 2 + row * (block + 1));
}

}  // namespace palpate::simd
