// SPDX-License-Identifier: MIT
// 32 registers of eight numbers: 24 sums, 3 lines of B and one number of A. Compiled for AVX-512.
#define PALPATE_TABLE kAvx512
#define PALPATE_NAME "AVX-512"
#define PALPATE_VECTOR_BYTES 64
#define PALPATE_TILE_ROWS 8
#define PALPATE_TILE_VECTORS 3
#include "gp/simd/kernels.inc"
