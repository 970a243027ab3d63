// SPDX-License-Identifier: MIT
// Replaces the compiler's header of the same name, and keeps Eigen from fusing multiplications with additions on ARM.
// So products of a matrix and a vector have the same bytes as on x86-64. Products of two matrices round in the same
// way, but add their terms in another order.
//
// Eigen 3.4 fuses in two places. The first is pmadd() in Eigen/src/Core/arch/NEON/PacketMath.h, if __ARM_FEATURE_FMA is
// defined. The second place is the product of two matrices in GeneralBlockPanelKernel.h, which uses the two intrinsics
// below. Highway uses neither the macro nor these intrinsics, so Highway's loops still fuse, as on x86-64 with AVX2.
#pragma once

#include_next <arm_neon.h>

#undef __ARM_FEATURE_FMA
#undef vfmaq_n_f64
#undef vfmaq_laneq_f64
#define vfmaq_n_f64(sum, vector, number) vaddq_f64(sum, vmulq_n_f64(vector, number))
#define vfmaq_laneq_f64(sum, vector, other, lane) vaddq_f64(sum, vmulq_laneq_f64(vector, other, lane))
