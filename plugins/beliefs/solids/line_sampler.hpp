// SPDX-License-Identifier: MIT
// The lines among which the next tap is chosen: half of them anywhere through the region, half along normals of the
// surface that is believed.
#pragma once

#include "solids/solids.hpp"

#include <palpate/belief.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// The ball in which objects are looked for: over the middle of the area, resting on the desk. Lengths relative to the
/// desk.
struct Region {
  explicit Region(const Area& area);
  Eigen::Vector3d centre;
  double radius = 0.0;  ///< metres
  /// Distance from the centre at which lines begin.
  double outside() const { return 1.5 * radius; }
};

/// Lines, and which of them go anywhere: the others are along a normal.
struct SampledLines {
  Candidates lines;
  std::vector<bool> anywhere;
};

/// Draws `count` lines that `filter` accepts, `desk` high the desk. The lines are along normals of `surface` only if
/// there is one. The first line goes anywhere, and of the others half. Throws Error if the filter rejects nearly all.
SampledLines sample_lines(const Region& region, double desk, std::size_t count, const Assembly* surface, Random& random,
                          const LineFilter& filter);

}  // namespace palpate
