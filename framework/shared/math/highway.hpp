// SPDX-License-Identifier: MIT
// Highway for loops that are compiled for several instruction sets and chosen as the program runs. A file of such loops
// defines HWY_TARGET_INCLUDE as its own path and includes this header, which Highway then reads once for each set:
// no include guard. Its functions stand in HWY_NAMESPACE, and are called by PALPATE_DISPATCH(function)(arguments).
//
// Highway is used by its headers alone. Its library would choose, too, but measures clocks when it is loaded, which
// takes as long as a fifth of a short run.
//
// The sets are AVX2 and AVX-512 (which Highway calls AVX3) on x86, NEON on ARM, and what every processor has. Vectors
// of SVE have no size that a compiler knows, so that arrays of them do not compile.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#define PALPATE_DISPATCH(function)                                                          \
  (*::palpate::math::version_of<decltype(&HWY_STATIC_DISPATCH(function))>(                  \
      {HWY_CHOOSE_FALLBACK(function), HWY_CHOOSE_NEON(function), HWY_CHOOSE_AVX2(function), \
       HWY_CHOOSE_AVX3(function)}))
#endif
#include "math/instructions.hpp"

#include <hwy/foreach_target.h>
// After the above, as Highway asks for.
#include <hwy/highway.h>
