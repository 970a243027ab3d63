// SPDX-License-Identifier: MIT
// What the moves of an outline draw their steps from: normal ones where the way back has to be weighed, and of all
// sizes where it is as probable as the way there.
#pragma once

#include "form.hpp"

#include <palpate/random.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::footprints {

/// Standard normal (Box and Muller 1958).
inline double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

/// Uniform in (-1, 1]: as good as a normal step where steps are of all sizes anyway, and quicker.
inline double either_way(Random& random) { return 1.0 - 2.0 * random.uniform(); }

/// A factor of a greatest step, from 1 down to a thirtieth, their logarithms evenly spaced: for posteriors of all
/// widths. A look-up is quicker than a power.
inline double some_scale(Random& random) {
  constexpr int kScales = 16;
  static const std::array<double, kScales> scales = [] {
    std::array<double, kScales> out{};
    for (int i = 0; i < kScales; ++i) out[static_cast<std::size_t>(i)] = std::pow(1.0 / 30.0, i / (kScales - 1.0));
    return out;
  }();
  return scales[static_cast<std::size_t>(random.bits() % kScales)];
}

}  // namespace palpate::footprints
