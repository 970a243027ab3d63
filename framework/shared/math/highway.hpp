// SPDX-License-Identifier: MIT
// Highway for loops that are compiled for several instruction sets and selected at run time. A file of such loops
// defines HWY_TARGET_INCLUDE as its own path and includes this header. Highway includes the file once per set, so this
// header has no include guard. The loops are in HWY_NAMESPACE, and PALPATE_DISPATCH(function)(arguments) calls them.
//
// Only Highway's headers are used. Highway's library could select the set, too. But the library measures clocks when it
// is loaded, which takes a fifth of the time of a short run. The assertions of debug builds need the library, so they
// are switched off.
//
// The sets on x86 are SSE2 (the baseline), AVX2 and AVX-512 (AVX3 in Highway). The only set on 64-bit ARM is NEON, its
// baseline. SVE is not used, because the size of its vectors is unknown to the compiler, so arrays of them do not
// compile.
#ifndef PALPATE_DISPATCH
#define HWY_IS_DEBUG_BUILD 0
#ifdef __aarch64__
#define HWY_COMPILE_ONLY_STATIC
#else
#define HWY_DISABLED_TARGETS (~(HWY_SCALAR | HWY_EMU128 | HWY_SSE2 | HWY_AVX2 | HWY_AVX3))
#endif
#include <hwy/detect_targets.h>
#ifndef HWY_SSE2
#define HWY_SSE2 0LL  // older versions than Highway 1.1 do not define it
#endif
#define PALPATE_DISPATCH(function)                                                          \
  (*::palpate::math::version_of<decltype(&HWY_STATIC_DISPATCH(function))>(                  \
      {HWY_CHOOSE_FALLBACK(function), HWY_CHOOSE_NEON(function), HWY_CHOOSE_AVX2(function), \
       HWY_CHOOSE_AVX3(function)}))
#endif
#include "math/instructions.hpp"

#include <hwy/foreach_target.h>
// Highway requires that foreach_target.h is included before highway.h.
#include <hwy/highway.h>

// Vectors of doubles in each set's HWY_NAMESPACE.
HWY_BEFORE_NAMESPACE();
namespace palpate::math::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
inline constexpr hn::ScalableTag<double> kReals;
using Vector = hn::Vec<hn::ScalableTag<double>>;
inline constexpr int kLanes = hn::MaxLanes(kReals);

// Load, store and broadcast. `from` and `to` are aligned to a vector.
HWY_INLINE Vector at(const double* from) { return hn::Load(kReals, from); }
HWY_INLINE void put(const Vector& values, double* to) { hn::Store(values, kReals, to); }
HWY_INLINE Vector all(double value) { return hn::Set(kReals, value); }

}  // namespace palpate::math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
