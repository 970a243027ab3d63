// SPDX-License-Identifier: MIT
#include "report/page/packed_maps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames) {
  constexpr double kMost = 65535.0;
  float least = frames.front().minCoeff();
  float most = least;
  for (const Eigen::VectorXf& frame : frames) {
    least = std::min(least, frame.minCoeff());
    most = std::max(most, frame.maxCoeff());
  }
  PackedMaps out{least, most, {}};
  const double scale = out.most > out.least ? kMost / (out.most - out.least) : 0.0;
  for (const Eigen::VectorXf& frame : frames) {
    std::string high;
    std::uint16_t before = 0;
    for (const float cell : frame) {
      const double value = scale * (static_cast<double>(cell) - out.least);
      const auto level = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, kMost)));
      const auto step = static_cast<std::uint16_t>(level - before);
      out.bytes += static_cast<char>(step & 0xFFU);
      high += static_cast<char>(step >> 8U);
      before = level;
    }
    out.bytes += high;
  }
  return out;
}

}  // namespace palpate
