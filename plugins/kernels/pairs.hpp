// SPDX-License-Identifier: MIT
// Squared distances of many pairs of places, in length scales: the first half of a stationary kernel's work.
#pragma once

#include <cstddef>

namespace palpate::kernels {

/// All pairs of n places with some others, counted by n for each of the others. Of each axis, a column of numbers.
struct Pairs {
  std::ptrdiff_t n;
  int axes;  ///< 1 or 2
  const double* places[2];
  const double* others[2];
  double per_length[2];  ///< 1 / length scale, 1 / metres
};

/// out_k = scale times the sum over the axes of min((distance per_length)^2, most), for `count` pairs from `first` on.
void squared_distances(const Pairs& pairs, std::ptrdiff_t first, std::ptrdiff_t count, double most, double scale,
                       double* out);

}  // namespace palpate::kernels
