// SPDX-License-Identifier: MIT
// Maps in a few bytes a cell. Smooth maps have small steps from cell to cell: steps of 16-bit numbers, their low and
// their high bytes apart, are what gzip makes least of.
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace palpate {

/// One quantity over the candidates at several moments; all frames have the same number of cells.
struct MapSeries {
  std::string name;
  std::vector<Eigen::VectorXf> frames;
};

/// The bytes of some series, one behind the other, and what a script needs to unpack them.
struct PackedMaps {
  std::string bytes;
  std::string json;  ///< a list of {name, least, most, frames}
};

/// Packs every series. A cell becomes a whole number from 0, for the least of all frames of its series, to 65535, for
/// the most: it is off by at most 1 / 131070 of that range. Then, a frame at a time, the steps from cell to cell modulo
/// 65536, first all their low bytes and then all their high bytes. Cells are finite.
PackedMaps pack_maps(const std::vector<MapSeries>& series);

}  // namespace palpate
