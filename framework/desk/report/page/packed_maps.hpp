// SPDX-License-Identifier: MIT
// Maps in a few bytes a cell. Smooth maps have small steps from cell to cell: steps of 16-bit numbers, their low and
// their high bytes apart, are what gzip makes least of.
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace palpate {

/// One quantity over the candidates at several moments, and what a script needs to unpack it.
struct PackedMaps {
  double least = 0.0;
  double most = 0.0;
  std::string bytes;
};

/// Packs frames of as many cells each, which are finite. A cell becomes a whole number from 0, for the least of all
/// frames, to 65535, for the most: it is off by at most 1 / 131070 of that range. Then, a frame at a time, the steps
/// from cell to cell modulo 65536, first all their low bytes and then all their high bytes.
PackedMaps pack_maps(const std::vector<Eigen::VectorXf>& frames);

}  // namespace palpate
