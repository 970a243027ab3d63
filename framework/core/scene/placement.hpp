// SPDX-License-Identifier: MIT
// Objects wholly inside the area, where the config puts them or at places drawn from the seed.
#pragma once

#include "scene/body.hpp"

#include <palpate/scene.hpp>

#include <cstdint>
#include <vector>

namespace palpate {

/// Throws Error, its `where` the path in the config, for the first body that does not lie wholly inside the area: no
/// tap would find what is outside, and no error measure would miss it.
void check_inside(const std::vector<Body>& bodies, const Area& area);

/// Draws rotation and position of each body until all lie wholly inside the area and none overlaps another: uniform
/// over all such poses. Each has a stream of random numbers of its own, so that one more object leaves the draws of the
/// others alone. Throws Error, its `where` the path in the config, when no such poses are found.
void place_at_random(std::vector<Body>& bodies, const Area& area, std::uint64_t seed);

/// Pushes bodies about as so many taps have; says whether any stands elsewhere. They stay wholly inside the area, and
/// apart.
bool push_about(std::vector<Body>& bodies, const Area& area, const Push& push, std::uint64_t seed, int taps);

}  // namespace palpate
