// SPDX-License-Identifier: MIT
#include "report/colours.hpp"

#include <algorithm>

namespace palpate {

const std::vector<std::string>& palette_stops(Palette palette) {
  static const std::vector<std::string> viridis{
      "#440154", "#481568", "#482677", "#453781", "#3f4788", "#39558c", "#32648e", "#2d718e", "#287d8e", "#238a8d",
      "#1f968b", "#20a386", "#29af7f", "#3cbc75", "#56c667", "#74d055", "#94d840", "#b8de29", "#dce318", "#fde725"};
  static const std::vector<std::string> cividis{"#00204d", "#00336f", "#39486b", "#575c6d", "#707173",
                                                "#8a8779", "#a69d75", "#c4b56c", "#e4cf5b", "#ffea46"};
  return palette == Palette::viridis ? viridis : cividis;
}

ColourScale deviation_colours(double least, double most) {
  constexpr double kFloor = 1e-6;  // metres; a micrometre is below the resolution of any measurement
  // The scale is logarithmic if `most` / `least` exceeds this ratio. A linear scale would then hide differences between
  // low values.
  constexpr double kWorthRatios = 5.0;
  least = std::max(least, kFloor);
  most = std::max(most, kFloor);
  const bool logarithmic = most > kWorthRatios * least;
  return {Palette::cividis, logarithmic ? 100.0 * least : 0.0, 100.0 * most, "standard deviation [cm]", logarithmic};
}

}  // namespace palpate
