// SPDX-License-Identifier: MIT
// Loops that are compiled twice, for processors that have wide vectors and for those that have not. What they compute
// is the same to the last bit: products are not fused with sums.
#pragma once

#include <palpate/simd.hpp>  // PALPATE_INLINE: what they call is compiled along with them

// Clang clones no function that has been declared without. The thread sanitizer would be called to choose one before it
// has begun.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PALPATE_CLONES
#endif
