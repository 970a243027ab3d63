// SPDX-License-Identifier: MIT
// Contours of the true scene: sections of its objects by planes, as closed lines.
#pragma once

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// A closed line: the last point is joined to the first point.
using Ring = std::vector<Eigen::Vector3d>;

/// Returns sections of the objects of a scene by horizontal and vertical planes, which are `apart` metres from each
/// other. Points are in metres, in the frame of the scene. The sections are limited to a box that stands on the desk,
/// in the middle of the area. The box is 0.92 times as wide and 0.76 times as high as the longer side of the area. The
/// points of a section are the points where the surface crosses the lines of a grid in the plane, with the spacing
/// `side` in metres. Straight lines join the points. A point is removed if it is within `side` / 10 of the straight
/// line between its remaining neighbours. The sections may miss parts of an object that are thinner than `side`.
std::vector<Ring> contours(const Scene& scene, double apart, double side);

}  // namespace palpate
