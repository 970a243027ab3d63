// SPDX-License-Identifier: MIT
// Dense symmetric positive definite matrices, lower triangles only, in place and in blocks: a fit spends its time here.
#pragma once

#include <palpate/types.hpp>

namespace palpate::fitting {

/// K -> L with L L^T = K; n x n, the upper triangle is neither read nor written. False when K is not positive definite
/// or not finite; then its content is lost.
bool factorise(MatrixOut matrix);

/// L -> lower triangle of (L L^T)^-1. 2 n^3 / 3 operations, in matrix products but for blocks that fit the first cache.
void invert_factored(MatrixOut matrix);

/// Writes the lower triangle over the upper one.
void mirror(MatrixOut matrix);

}  // namespace palpate::fitting
