// SPDX-License-Identifier: MIT
#include "gp/simd/table.hpp"

namespace palpate::simd {

bool runs(const Table& table) {
  if (&table == &kAvx512) return __builtin_cpu_supports("avx512f") != 0;
  if (&table == &kAvx2) return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  return true;
}

const Table& baseline() { return kSse2; }

const Table& fastest() {
  if (runs(kAvx512)) return kAvx512;
  return runs(kAvx2) ? kAvx2 : kSse2;
}

std::size_t packed_row(int i) {
  const auto line = static_cast<std::size_t>(kLine<double>);
  const std::size_t block = static_cast<std::size_t>(i) / line;
  const std::size_t row = static_cast<std::size_t>(i) % line;
  // The blocks before have 1, 2, ... lines a row.
  return line * (line * block * (block + 1) / 2 + row * (block + 1));
}

}  // namespace palpate::simd
