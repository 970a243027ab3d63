// SPDX-License-Identifier: MIT
// Samples the lines among which the next tap is chosen: half at random through the region, half along normals of the
// estimated surface.
#pragma once

#include "solids/assembly_sampler.hpp"

#include <palpate/belief.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpate {

/// The ball in which objects are searched. Its centre is above the middle of the area, at 0.65 of its radius above the
/// desk. Heights are relative to the desk.
struct SearchBall {
  explicit SearchBall(const Area& area);
  Eigen::Vector3d centre;
  double radius = 0.0;  ///< metres
  /// Distance from the centre at which lines begin.
  double outside() const { return 1.5 * radius; }
};

/// Lines, and a flag per line: drawn at random (`anywhere`), or along a normal of the surface.
struct SampledLines {
  Candidates lines;
  std::vector<bool> anywhere;
};

/// Draws `count` lines that `filter` accepts. `desk`: height of the desk, metres. Half of the lines, the first
/// included, are drawn at random, the others along normals of `surface`. Without a surface, all are random. Throws
/// Error if the filter rejects nearly all.
SampledLines sample_lines(const SearchBall& region, double desk, std::size_t count, const Assembly* surface,
                          Random& random, const LineFilter& filter);

}  // namespace palpate
