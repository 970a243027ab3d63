// SPDX-License-Identifier: MIT
// Squared scaled distances of many pairs of positions, the first step of a stationary kernel.
#pragma once

#include <cstddef>

namespace palpate::kernels {

/// All pairs of n positions with other positions, ordered by the other position. The arrays are coordinates, one array
/// per axis.
struct Pairs {
  std::ptrdiff_t n;
  int axes;  ///< number of axes, 1 or 2
  const double* places[2];
  const double* others[2];
  double per_length[2];  ///< 1 / length scale, 1 / metres
};

/// Computes out_k = scale * (sum over axes of min((distance * per_length)^2, most)) for `count` pairs starting at
/// `first`.
void squared_distances(const Pairs& pairs, std::ptrdiff_t first, std::ptrdiff_t count, double most, double scale,
                       double* out);

}  // namespace palpate::kernels
