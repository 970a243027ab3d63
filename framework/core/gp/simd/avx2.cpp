// SPDX-License-Identifier: MIT
// 16 registers of four numbers: 12 sums, 3 lines of B and one number of A. Compiled for AVX2 and FMA.
#define PALPATE_TABLE kAvx2
#define PALPATE_NAME "AVX2+FMA"
#define PALPATE_VECTOR_BYTES 32
#define PALPATE_TILE_ROWS 4
#define PALPATE_TILE_VECTORS 3
#include "gp/simd/kernels.inc"
