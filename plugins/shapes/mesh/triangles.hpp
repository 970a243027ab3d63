// SPDX-License-Identifier: MIT
// A surface of triangles that share their corners, checked to be one.
#pragma once

#include "options.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::shapes {

/// In metres, in the frame of Shape: resting on the plane 0, the rectangle around the outline centred.
struct Triangles {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< numbers of points
};

/// Reads a surface, joins its equal points and moves it into place. Throws Error, its `where` the file: what
/// read_file() and import_triangles() throw; a coordinate that is not finite, larger than 2 m, smaller than 1 mm, or so
/// far from the origin of the file that single precision is coarser than 1e-6 m; triangles without area or there twice
/// and, unless allowed, holes: edges of one triangle only.
Triangles read_surface(const MeshOptions& options);

}  // namespace palpate::shapes
