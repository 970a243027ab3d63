// SPDX-License-Identifier: MIT
// Placement of objects inside the area: checks of configured poses, random poses, and pushes.
#pragma once

#include "scene/body.hpp"

#include <palpate/scene.hpp>

#include <cstdint>
#include <vector>

namespace palpate {

/// Throws Error for the first body that is not wholly inside the area. The place of the Error is the body's path in the
/// config. A part outside the area is not allowed, because it can neither be tapped nor appear in the errors.
void check_inside(const std::vector<Body>& bodies, const Area& area);

/// Draws rotations and positions of all bodies until all bodies are inside the area and no two bodies overlap. The
/// result is uniformly distributed over all poses with these properties. Each body has its own random stream, so an
/// additional object does not change the draws of the others. Throws Error if no poses with these properties are found;
/// its place is the path in the config.
void place_at_random(std::vector<Body>& bodies, const Area& area, std::uint64_t seed);

/// Moves bodies as the first `taps` taps of a run would have pushed them. Returns whether a body has moved. The bodies
/// stay inside the area and do not overlap.
bool push_about(std::vector<Body>& bodies, const Area& area, const Push& push, std::uint64_t seed, int taps);

}  // namespace palpate
