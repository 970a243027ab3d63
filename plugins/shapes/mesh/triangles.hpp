// SPDX-License-Identifier: MIT
// From the bytes of a file to a surface of triangles that share their corners, checked to be one.
#pragma once

#include "options.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::shapes {

constexpr std::size_t kMostTriangles = 5'000'000;

/// Corners in the units of the file, three a triangle, single precision as assimp reads them.
using Soup = std::vector<std::array<float, 3>>;

/// By assimp, of which import.cpp is the only user. Reads STL, OBJ or PLY, told apart by the ending of `file`; faces of
/// more than three corners are divided. Reads no other file, such as the materials of an OBJ. Works in a process of its
/// own, which a broken file may kill. Throws Error, its `where` the file: another format, cut short, not to be
/// understood, no triangle, too many.
Soup import_triangles(std::string bytes, const std::string& file);

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
