// SPDX-License-Identifier: MIT
// Functions that read and check triangle surfaces.
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

/// Three corners per triangle, in the units of the file. They have single precision, as assimp returns them.
using Soup = std::vector<std::array<float, 3>>;

/// Reads an STL, OBJ or PLY file with assimp, depending on the extension of `file`. Faces with more than three corners
/// are divided. Other files, such as the materials of an OBJ, are not read. A child process does the work, because
/// broken files may crash assimp. Throws Error with the file as its place if the format is not one of these, or if the
/// file is truncated, invalid, without triangles, or with too many.
Soup import_triangles(std::string bytes, const std::string& file);

/// Triangles in metres, in the frame of Shape. The lowest point is at height 0, and the bounding rectangle of the
/// outline is centred.
struct Triangles {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< indices of the corners in `points`
};

/// Reads a surface, merges equal points and moves it into place. Throws Error with the file as its place:
/// - errors of read_file() and import_triangles();
/// - coordinates that are not finite, a size above 2 m or below 1 mm, or a distance from the origin at which single
///   precision is coarser than 1e-6 m;
/// - triangles without area or listed twice, and, unless allowed, holes: edges of only one triangle.
Triangles read_surface(const MeshOptions& options);

}  // namespace palpate::shapes
