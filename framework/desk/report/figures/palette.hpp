// SPDX-License-Identifier: MIT
// The colours of maps: even steps in lightness, so that equal differences look equal, also in grey and to people who
// see two colours alike.
#pragma once

#include <string>
#include <vector>

namespace palpate {

enum class Palette {
  viridis,  ///< dark blue over green to yellow: where to tap
  cividis,  ///< dark blue over grey to yellow: what is not known
};

/// Evenly spaced stops from the lowest value to the highest, each "#rrggbb".
const std::vector<std::string>& palette_stops(Palette palette);

/// gnuplot's `set palette`, one line.
std::string gnuplot_palette(Palette palette);

}  // namespace palpate
