// SPDX-License-Identifier: MIT
// What the moves of an outline draw their steps from: normal ones where the way back has to be weighed, and of all
// sizes where it is as probable as the way there.
#pragma once

#include "form.hpp"

#include <palpate/math.hpp>
#include <palpate/random.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpate::footprints {

/// Standard normal (Box and Muller 1958).
inline double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * math::log(1.0 - random.uniform()));
  return radius * math::cos(2.0 * kPi * random.uniform());
}

/// What a move of a form steps by, all of one draw of 64 bits: as good as normal steps where steps are of all sizes
/// anyway, and quicker.
struct Steps {
  explicit Steps(Random& random) {
    // A factor from 1 down to a twentieth, their logarithms evenly spaced: for posteriors of all widths.
    constexpr int kScales = 16;
    static const std::array<double, kScales> scales = [] {
      std::array<double, kScales> out{};
      for (int i = 0; i < kScales; ++i) out[static_cast<std::size_t>(i)] = math::pow(1.0 / 20.0, i / (kScales - 1.0));
      return out;
    }();
    const std::uint64_t bits = random.bits();
    const double scale = scales[bits % kScales];
    const auto even = [scale](std::uint64_t number) {
      return scale * (1.0 - 0x1.0p-27 * static_cast<double>(static_cast<std::int32_t>(number & 0xFFFFFFF)));
    };
    heads = (bits & 0x10) != 0;
    also_heads = (bits & 0x20) != 0;
    one = even(bits >> 8);
    other = even(bits >> 36);
  }

  double one, other;       ///< up to 1 either way
  bool heads, also_heads;  ///< of two coins
};

}  // namespace palpate::footprints
