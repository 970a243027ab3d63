// SPDX-License-Identifier: MIT
// Loops over numbers in the widest registers that a run may use, for plugins: written once, for one number, compiled
// for SSE2, AVX2 and AVX-512, and chosen as the program runs. A column of a kernel, for one:
//
//     simd::for_each(lanes_, n, [=](std::ptrdiff_t i) { out[i] = simd::exp(-0.5 * squares[i]); });
//
// Take `lanes_` from Context::lanes: a run with PALPATE_INSTRUCTIONS=baseline then does without the wider ones.
//
// The compiler turns the loop into vectors where the function can be seen as a whole and does not branch: arithmetic,
// std::sqrt, std::abs, and what is offered here; a pointer is best taken into the function by value. Where it does not,
// a loop is slower and no less right. An optimisation of -O3 is needed, and the flags of the CMake package
// (-fno-math-errno, -fno-trapping-math). Multiplications and additions may be fused where the processor can; the same
// set of instructions gives the same bytes on every machine, and a number's bytes do not hang on its place in the loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate::simd {

/// Sets of instructions, each with all of those before it.
enum class Lanes {
  sse2,    ///< two numbers a register: every x86-64
  avx2,    ///< four
  avx512,  ///< eight
};

/// The largest set that this processor has: what a compiler may take for x86-64-v3 and -v4. Some processors have
/// AVX-512F and not the rest of v4.
inline Lanes widest() {
  const bool v3 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
                  __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
  if (!v3) return Lanes::sse2;
  const bool v4 = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                  __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
                  __builtin_cpu_supports("avx512vl") != 0;
  return v4 ? Lanes::avx512 : Lanes::avx2;
}

// A function that is not inlined would be code for one set that a linker may take for all.
#define PALPATE_INLINE __attribute__((always_inline)) inline
#define PALPATE_AVX2 __attribute__((target("avx2,fma,bmi,bmi2")))
#if defined(__clang__)
#define PALPATE_AVX512 __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512bw,avx512cd,avx512dq,avx512vl")))
#define PALPATE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define PALPATE_AVX512 \
  __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512bw,avx512cd,avx512dq,avx512vl,prefer-vector-width=512")))
#define PALPATE_INDEPENDENT _Pragma("GCC ivdep")
#endif

/// `condition ? a : b` by masks: a branch, which compilers make of constants, would end the vectors.
PALPATE_INLINE double select(bool condition, double a, double b) {
  const std::uint64_t mask = -static_cast<std::uint64_t>(condition);
  std::uint64_t first;
  std::uint64_t second;
  std::memcpy(&first, &a, sizeof a);
  std::memcpy(&second, &b, sizeof b);
  first = (first & mask) | (second & ~mask);
  std::memcpy(&a, &first, sizeof a);
  return a;
}

/// The smaller and the larger of two numbers; `b` where one of them is NaN.
PALPATE_INLINE double min(double a, double b) { return select(a < b, a, b); }
PALPATE_INLINE double max(double a, double b) { return select(a > b, a, b); }

namespace detail {

/// e^x where 2^n and e^x are doubles: x from -708 to 709.79, and `bounded` is the smaller of x and 709.
///
/// x = n ln 2 + r with |r| <= ln 2 / 2 (n that of `bounded`), where what the series leaves out beyond r^13 / 13! is
/// less than 5e-18.
PALPATE_INLINE double exp_within(double x, double bounded) {
  // A number of this size ends in its integer: n + 1023, the exponent of 2^n.
  constexpr double kShift = 0x1.8p52 + 1023.0;
  const double shifted = bounded * 0x1.71547652b82fep0 + kShift;  // 1 / ln 2
  const double n = shifted - kShift;
  // ln 2 in two parts, the first of them short enough for n times it to be exact.
  const double r = (x - n * 0x1.62e42feep-1) - n * 0x1.a39ef35793c76p-33;
  double sum = 1.0 / 6227020800;
  sum = sum * r + 1.0 / 479001600;
  sum = sum * r + 1.0 / 39916800;
  sum = sum * r + 1.0 / 3628800;
  sum = sum * r + 1.0 / 362880;
  sum = sum * r + 1.0 / 40320;
  sum = sum * r + 1.0 / 5040;
  sum = sum * r + 1.0 / 720;
  sum = sum * r + 1.0 / 120;
  sum = sum * r + 1.0 / 24;
  sum = sum * r + 1.0 / 6;
  sum = sum * r + 1.0 / 2;
  sum = (sum * r) * r + r + 1.0;
  std::uint64_t bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits <<= 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return sum * power;
}

}  // namespace detail

/// e^x within 1 ulp (measured: 0.70). Never below e^-708 = 3.3e-308; infinity above 709.79; NaN of NaN.
PALPATE_INLINE double exp(double x) {
  const double bounded = max(-708.0, x);
  return detail::exp_within(bounded, min(bounded, 709.0));
}

/// e^-x of x >= 0, the same number as exp(-x) in fewer instructions: what covariances fall by. NaN of NaN.
PALPATE_INLINE double decay(double x) {
  constexpr double kLeast = 0x1.7c8ab2288c9acp-1022;             // e^-708
  return select(x > 708.0, kLeast, detail::exp_within(-x, -x));  // nothing waits for the bound
}

namespace detail {

template <class Function>
PALPATE_INLINE void loops(std::ptrdiff_t n, std::ptrdiff_t m, const Function& function) {
  for (std::ptrdiff_t j = 0; j < m; ++j) {
    PALPATE_INDEPENDENT
    for (std::ptrdiff_t i = 0; i < n; ++i) function(i, j);
  }
}
// The functions go by value: what they hold may then stay in registers.
template <class Function>
__attribute__((flatten)) void on_sse2(std::ptrdiff_t n, std::ptrdiff_t m, Function function) {
  loops(n, m, function);
}
template <class Function>
PALPATE_AVX2 __attribute__((flatten)) void on_avx2(std::ptrdiff_t n, std::ptrdiff_t m, Function function) {
  loops(n, m, function);
}
template <class Function>
PALPATE_AVX512 __attribute__((flatten)) void on_avx512(std::ptrdiff_t n, std::ptrdiff_t m, Function function) {
  loops(n, m, function);
}

}  // namespace detail

/// Calls function(i, j) for j = 0, 1, ... m - 1 and for each of them i = 0, 1, ... n - 1, of which some go at once: no
/// call may read what another one of the same j writes.
template <class Function>
void for_each(Lanes lanes, std::ptrdiff_t n, std::ptrdiff_t m, const Function& function) {
  if (lanes == Lanes::avx512) return detail::on_avx512(n, m, function);
  if (lanes == Lanes::avx2) return detail::on_avx2(n, m, function);
  detail::on_sse2(n, m, function);
}

/// The same with one j.
template <class Function>
void for_each(Lanes lanes, std::ptrdiff_t n, const Function& function) {
  for_each(lanes, n, 1, [function](std::ptrdiff_t i, std::ptrdiff_t) { function(i); });
}

}  // namespace palpate::simd
