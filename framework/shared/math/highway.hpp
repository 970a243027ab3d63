// SPDX-License-Identifier: MIT
// Highway for loops that are compiled for several instruction sets and chosen as the program runs. A file of such loops
// defines HWY_TARGET_INCLUDE as its own path and includes this header, which Highway then reads once for each set:
// no include guard. Its functions stand in HWY_NAMESPACE, and are called by PALPATE_DISPATCH(function)(arguments).
//
// Highway is used by its headers alone. Its library would choose, too, but measures clocks when it is loaded, which
// takes as long as a fifth of a short run. Its assertions, which debug builds have, are in the library, too.
//
// The sets are AVX2 and AVX-512 (which Highway calls AVX3) on x86, and what every processor of the architecture has: on
// 64-bit ARM that is NEON. Vectors of SVE have no size that a compiler knows, so that arrays of them do not compile.
#ifndef PALPATE_DISPATCH
#define HWY_IS_DEBUG_BUILD 0
#ifdef __aarch64__
#define HWY_COMPILE_ONLY_STATIC
#else
#define HWY_DISABLED_TARGETS (~(HWY_SCALAR | HWY_EMU128 | HWY_SSE2 | HWY_AVX2 | HWY_AVX3))
#endif
#include <hwy/detect_targets.h>
#ifndef HWY_SSE2
#define HWY_SSE2 0LL  // Highway has it from 1.1 on
#endif
#define PALPATE_DISPATCH(function)                                                          \
  (*::palpate::math::version_of<decltype(&HWY_STATIC_DISPATCH(function))>(                  \
      {HWY_CHOOSE_FALLBACK(function), HWY_CHOOSE_NEON(function), HWY_CHOOSE_AVX2(function), \
       HWY_CHOOSE_AVX3(function)}))
#endif
#include "math/instructions.hpp"

#include <hwy/foreach_target.h>
// After the above, as Highway asks for.
#include <hwy/highway.h>

// Real numbers of each set, for the functions in its HWY_NAMESPACE.
HWY_BEFORE_NAMESPACE();
namespace palpate::math::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
inline constexpr hn::ScalableTag<double> kReals;
using Vector = hn::Vec<hn::ScalableTag<double>>;
inline constexpr int kLanes = hn::MaxLanes(kReals);

/// `from` and `to` are aligned to a vector.
HWY_INLINE Vector at(const double* from) { return hn::Load(kReals, from); }
HWY_INLINE void put(const Vector& values, double* to) { hn::Store(values, kReals, to); }
HWY_INLINE Vector all(double value) { return hn::Set(kReals, value); }

}  // namespace palpate::math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
