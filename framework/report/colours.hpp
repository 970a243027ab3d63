// SPDX-License-Identifier: MIT
// The colours of figures and pages.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace palpate {

/// Colours of curves, which remain distinct with every kind of colour vision (Okabe and Ito 2008, Color universal
/// design), and a brown.
inline constexpr std::array<const char*, 8> kLineColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                         "#56b4e9", "#e69f00", "#000000", "#8c6d46"};
/// The same for a dark background.
inline constexpr std::array<const char*, 8> kLineColoursOnDark{"#56b4e9", "#e69f00", "#009e73", "#cc79a7",
                                                               "#f0e442", "#d55e00", "#ffffff", "#c9a66b"};

/// Colour scales of maps. Their lightness grows evenly, so equal differences look equal, also in grey and to people
/// with a colour vision deficiency.
enum class Palette {
  viridis,  ///< dark blue over green to yellow: values that say where to tap
  cividis,  ///< dark blue over grey to yellow: uncertainties
};

/// Returns evenly spaced colours from the lowest value to the highest, each "#rrggbb".
const std::vector<std::string>& palette_stops(Palette palette);

/// The colour scale of some panels.
struct Colours {
  Palette palette = Palette::viridis;
  double low = 0.0;
  double high = 1.0;
  std::string label;  ///< with the unit
  bool logarithmic = false;
};

/// Returns the scale for standard deviations of the height from `least` to `most` metres, in centimetres. If the ratio
/// of the two is large, the scale is logarithmic: on a linear scale all touched places would look alike beside the
/// places without a tap, whose standard deviation is up to a hundred times as large.
Colours deviation_colours(double least, double most);

}  // namespace palpate
