// SPDX-License-Identifier: MIT
#include "gp/simd/table.hpp"

namespace palpate::simd {

// What a compiler may take for x86-64-v3 and -v4 (CMakeLists.txt). Some processors have AVX-512F and not the rest of
// v4.
bool runs(const Table& table) {
  const bool v3 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
                  __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
  if (&table == &kAvx2) return v3;
  if (&table == &kAvx512) {
    return v3 && __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
           __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
  }
  return true;
}

const Table& baseline() { return kSse2; }

const Table& fastest() {
  if (runs(kAvx512)) return kAvx512;
  return runs(kAvx2) ? kAvx2 : kSse2;
}

std::size_t packed_row(int i) {
  const auto line = static_cast<std::size_t>(kLine);
  const std::size_t block = static_cast<std::size_t>(i) / line;
  const std::size_t row = static_cast<std::size_t>(i) % line;
  // The blocks before have 1, 2, ... lines a row.
  return line * (line * block * (block + 1) / 2 + row * (block + 1));
}

}  // namespace palpate::simd
