// SPDX-License-Identifier: MIT
#include "report/page/packed_maps.hpp"

#include "record/row.hpp"
#include "report/page/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {
namespace {

constexpr double kMost = 65535.0;

void pack_frame(const Eigen::VectorXf& frame, double least, double most, std::string& out) {
  const double scale = most > least ? kMost / (most - least) : 0.0;
  const std::size_t low = out.size();
  const auto cells = static_cast<std::size_t>(frame.size());
  out.resize(low + 2 * cells);
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const double value = static_cast<double>(frame(static_cast<Eigen::Index>(i))) - least;
    const auto level = static_cast<std::uint16_t>(std::lround(std::clamp(value * scale, 0.0, kMost)));
    const auto step = static_cast<std::uint16_t>(level - before);
    out[low + i] = static_cast<char>(step & 0xFFU);
    out[low + cells + i] = static_cast<char>(step >> 8U);
    before = level;
  }
}

}  // namespace

PackedMaps pack_maps(const std::vector<MapSeries>& series) {
  PackedMaps out;
  std::vector<std::string> described;
  for (const MapSeries& one : series) {
    double least = one.frames.front().minCoeff();
    double most = least;
    for (const Eigen::VectorXf& frame : one.frames) {
      least = std::min(least, static_cast<double>(frame.minCoeff()));
      most = std::max(most, static_cast<double>(frame.maxCoeff()));
    }
    for (const Eigen::VectorXf& frame : one.frames) pack_frame(frame, least, most, out.bytes);
    described.push_back(json_object({{"name", json_quoted(one.name)},
                                     {"least", json_value(least)},
                                     {"most", json_value(most)},
                                     {"frames", std::to_string(one.frames.size())}}));
  }
  out.json = json_list(described);
  return out;
}

}  // namespace palpate
