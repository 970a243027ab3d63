// SPDX-License-Identifier: MIT
// Stands before the compiler's header of the same name, and keeps Eigen from fusing multiplications with additions on
// ARM. So products of vectors and matrices round as on x86-64, and runs on both make the same taps.
//
// Eigen 3.4 has two places that fuse: pmadd() in Eigen/src/Core/arch/NEON/PacketMath.h, where the compiler says that it
// can, and products of two matrices in GeneralBlockPanelKernel.h beside it, by the two intrinsics below. Highway, whose
// loops fuse on every processor, uses neither.
#pragma once

#include_next <arm_neon.h>

#undef __ARM_FEATURE_FMA
#define vfmaq_n_f64(sum, vector, number) vaddq_f64(sum, vmulq_n_f64(vector, number))
#define vfmaq_laneq_f64(sum, vector, other, lane) vaddq_f64(sum, vmulq_laneq_f64(vector, other, lane))
