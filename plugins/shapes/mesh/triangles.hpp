// SPDX-License-Identifier: MIT
// A surface of triangles that share their corners, checked to be one.
#pragma once

#include "import.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace palpate::shapes {

/// In metres, in the frame of Shape: resting on the plane 0, the rectangle around the outline centred.
struct Triangles {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< numbers of points
};

/// How the coordinates of a file are to be taken.
struct Frame {
  double unit;   ///< metres
  bool y_is_up;  ///< else z
};

/// Joins equal points and moves the surface into place. Throws Error, its `where` the file: a coordinate that is not
/// finite, larger than 2 m, smaller than 1 mm, or so far from the origin of the file that single precision is coarser
/// than 1e-6 m.
Triangles join(const Soup& soup, const Frame& frame, const std::string& file);

/// Throws Error, its `where` the file, for triangles without area or there twice and, unless allowed, for holes: edges
/// of one triangle only.
void check_surface(const Triangles& mesh, bool holes_allowed, const std::string& file);

}  // namespace palpate::shapes
