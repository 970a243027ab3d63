// SPDX-License-Identifier: MIT
// Contours of the true scene: the closed lines along which planes cut the surfaces of the objects.
#pragma once

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// A closed line: the last point is joined to the first point.
using Ring = std::vector<Eigen::Vector3d>;

/// Returns the sections of a scene's objects with horizontal planes and with vertical planes. Neighbouring planes are
/// `apart` metres from each other. Points are in metres, in the frame of the scene. The sections are limited to a box
/// that stands on the desk, in the middle of the area. The box is 0.92 times as wide and 0.76 times as high as the
/// longer side of the area. Each plane has a grid of lines with the spacing `side` in metres. The points of a section
/// are the points where the surface crosses these lines, joined by straight lines. A point is removed if it is within
/// `side` / 10 of the straight line between its remaining neighbours. The sections may miss parts of an object that are
/// thinner than `side`.
std::vector<Ring> contours(const Scene& scene, double apart, double side);

}  // namespace palpate
