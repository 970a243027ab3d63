// SPDX-License-Identifier: MIT
#include "report/figures/palette.hpp"

#include <fmt/format.h>

namespace palpate {

const std::vector<std::string>& palette_stops(Palette palette) {
  static const std::vector<std::string> viridis{
      "#440154", "#481568", "#482677", "#453781", "#3f4788", "#39558c", "#32648e", "#2d718e", "#287d8e", "#238a8d",
      "#1f968b", "#20a386", "#29af7f", "#3cbc75", "#56c667", "#74d055", "#94d840", "#b8de29", "#dce318", "#fde725"};
  static const std::vector<std::string> cividis{"#00204d", "#00336f", "#39486b", "#575c6d", "#707173",
                                                "#8a8779", "#a69d75", "#c4b56c", "#e4cf5b", "#ffea46"};
  return palette == Palette::viridis ? viridis : cividis;
}

std::string gnuplot_palette(Palette palette) {
  std::string out = "set palette defined (";
  const std::vector<std::string>& stops = palette_stops(palette);
  for (std::size_t i = 0; i < stops.size(); ++i) out += fmt::format("{}{} '{}'", i > 0 ? ", " : "", i, stops[i]);
  return out + ")\n";
}

}  // namespace palpate
