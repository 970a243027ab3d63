// SPDX-License-Identifier: MIT
// Highway for loops that are compiled for several instruction sets and chosen as the program runs. A file of such loops
// defines HWY_TARGET_INCLUDE as its own path and includes this header, which Highway then reads once for each set:
// no include guard.
//
// The sets are AVX2 and AVX-512 (which Highway calls AVX3) on x86, NEON on ARM, and what every processor has. Vectors of
// SVE have no size that a compiler knows, so that arrays of them do not compile.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
#include <hwy/foreach_target.h>
// After the above, as Highway asks for.
#include <hwy/highway.h>
