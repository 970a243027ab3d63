// SPDX-License-Identifier: MIT
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <atomic>
#include <cstdlib>
#include <string>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace palpate {
namespace {

#if defined(__x86_64__)
/// Returns whether the processor has F16C, for which clang 14 knows no name.
bool has_f16c() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  return __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & bit_F16C) != 0;
}
#endif

/// Returns the widest set of the processor. Highway requires the same processor features for its targets
/// (math/highway.hpp).
Instructions widest() {
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
                    __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0 &&
                    __builtin_cpu_supports("aes") != 0 && __builtin_cpu_supports("pclmul") != 0 && has_f16c();
  const bool avx512 = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
                      __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                      __builtin_cpu_supports("avx512cd") != 0;
  return !avx2 ? Instructions::baseline : avx512 ? Instructions::avx512 : Instructions::avx2;
#elif defined(__aarch64__)
  return Instructions::neon;
#else
  return Instructions::baseline;
#endif
}

std::atomic<Instructions>& selected() {
  static std::atomic<Instructions> out{widest()};
  return out;
}

}  // namespace

Instructions instructions_in_use() { return selected().load(std::memory_order_relaxed); }

void use_instructions(Instructions set) { selected().store(set, std::memory_order_relaxed); }

namespace math {

const char* name_of(Instructions set) {
  static constexpr const char* kNames[] = {"baseline", "NEON", "AVX2", "AVX-512"};
  return kNames[static_cast<std::size_t>(set)];
}

std::vector<Instructions> instruction_sets() {
  switch (widest()) {
    case Instructions::avx512:
      return {Instructions::avx512, Instructions::avx2, Instructions::baseline};
    case Instructions::avx2:
      return {Instructions::avx2, Instructions::baseline};
    default:
      return {widest()};
  }
}

Instructions choose_instructions() {
  const char* const name = "PALPATE_INSTRUCTIONS";
  const char* const value = std::getenv(name);
  const std::string wanted = value != nullptr ? value : "";
  std::string known;
  for (const Instructions one : instruction_sets()) {
    if (!wanted.empty() && wanted != name_of(one)) {
      known += (known.empty() ? "" : " or ") + std::string(name_of(one));
      continue;
    }
    use_instructions(one);
    return one;
  }
  throw Error(name, "unknown value '" + wanted + "'", "write " + known + ", or unset it");
}

}  // namespace math
}  // namespace palpate
