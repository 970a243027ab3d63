// SPDX-License-Identifier: MIT
// Every x86-64 has these instructions. 16 registers of two numbers; no fused multiply-add, so one is left for products.
#define PALPATE_TABLE kSse2
#define PALPATE_NAME "SSE2"
#define PALPATE_VECTOR_BYTES 16
#define PALPATE_TILE_ROWS 4
#define PALPATE_TILE_VECTORS 2
#include "gp/simd/kernels.inc"
