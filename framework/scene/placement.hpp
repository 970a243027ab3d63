// SPDX-License-Identifier: MIT
// Placement of objects inside the area: checks of configured poses, random poses, and pushes.
#pragma once

#include "scene/body.hpp"

#include <palpate/scene.hpp>

#include <cstdint>
#include <vector>

namespace palpate {

/// Throws Error, with the path in the config as its place, for the first body that is not wholly inside the area. Taps
/// would miss the part outside, but error measures would not show it.
void check_inside(const std::vector<Body>& bodies, const Area& area);

/// Draws rotation and position of all bodies until all are inside the area and no two overlap. The result is uniform
/// over all such poses. Each body has its own random stream, so that a further object does not change the draws of the
/// others. Throws Error, with the path in the config as its place, if no such poses are found.
void place_at_random(std::vector<Body>& bodies, const Area& area, std::uint64_t seed);

/// Moves bodies as `taps` taps would have pushed them. Returns whether a body has moved. The bodies stay inside the
/// area and apart from each other.
bool push_about(std::vector<Body>& bodies, const Area& area, const Push& push, std::uint64_t seed, int taps);

}  // namespace palpate
