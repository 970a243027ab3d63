// SPDX-License-Identifier: MIT
// The colours of figures and pages.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace palpate {

/// Colours of curves: the palette of Okabe and Ito (2008, Color universal design), which remains distinct with every
/// kind of colour vision, and a brown.
inline constexpr std::array<const char*, 8> kLineColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                         "#56b4e9", "#e69f00", "#000000", "#8c6d46"};
/// The colours of curves for a dark background.
inline constexpr std::array<const char*, 8> kLineColoursOnDark{"#56b4e9", "#e69f00", "#009e73", "#cc79a7",
                                                               "#f0e442", "#d55e00", "#ffffff", "#c9a66b"};

/// Colour scales of maps. Lightness grows evenly along each scale. Equal differences therefore look equal, even in grey
/// prints and to people with a colour vision deficiency.
enum class Palette {
  viridis,  ///< from dark blue through green to yellow, for values that show where to tap
  cividis,  ///< from dark blue through grey to yellow, for uncertainties
};

/// Returns evenly spaced colours from the lowest value to the highest, each "#rrggbb".
const std::vector<std::string>& palette_stops(Palette palette);

/// The colour scale that one or more panels share.
struct ColourScale {
  Palette palette = Palette::viridis;
  double low = 0.0;
  double high = 1.0;
  std::string label;  ///< text of the scale, with the unit
  bool logarithmic = false;
};

/// Returns the scale for standard deviations of the height from `least` to `most` metres, in centimetres. The scale is
/// logarithmic if the ratio of `most` to `least` is large. On a linear scale all tapped positions would then look
/// alike, because untapped positions have a standard deviation up to a hundred times as large.
ColourScale deviation_colours(double least, double most);

}  // namespace palpate
