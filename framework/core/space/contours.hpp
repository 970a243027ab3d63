// SPDX-License-Identifier: MIT
// What truly stands there as lines to be drawn: where planes cut its surface.
#pragma once

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// A closed line: its last point is joined to its first.
using Ring = std::vector<Eigen::Vector3d>;

/// The sections of the objects of a scene by level and upright planes, `apart` from each other, through the ball of
/// this radius around `centre` as far as it is above the desk; metres, heights relative to the desk. They lie on the
/// surface where they cross lines of a grid of `side` in their plane, and are straight between these; points that are
/// within a tenth of it of such a straight line are left out. What is thinner than `side` may be missed.
std::vector<Ring> contours(const Scene& scene, const Eigen::Vector3d& centre, double radius, double apart, double side);

}  // namespace palpate
