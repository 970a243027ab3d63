// SPDX-License-Identifier: MIT
// The true scene as lines: sections of its objects by planes.
#pragma once

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// A closed line: its last point is joined to its first.
using Ring = std::vector<Eigen::Vector3d>;

/// Returns sections of the objects of a scene by level and upright planes, `apart` metres from each other, through a
/// ball over the middle of the area as far as it is above the desk; metres, in the frame of the scene. Sections lie on
/// the surface where they cross lines of a grid of `side` in their plane, and are straight between these crossings.
/// Points within a tenth of `side` of such a straight line are left out. Parts thinner than `side` may be missed.
std::vector<Ring> contours(const Scene& scene, double apart, double side);

}  // namespace palpate
