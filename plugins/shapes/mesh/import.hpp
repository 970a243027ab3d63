// SPDX-License-Identifier: MIT
// From the bytes of a file to bare triangles: the only user of assimp.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace palpate::shapes {

constexpr std::size_t kMostTriangles = 5'000'000;

/// Corners in the units of the file, three a triangle, single precision as assimp reads them.
using Soup = std::vector<std::array<float, 3>>;

/// Reads STL, OBJ or PLY, told apart by the ending of `file`; faces of more than three corners are divided. Reads no
/// other file, such as the materials of an OBJ. Works in a process of its own, which a broken file may kill. Throws
/// Error, its `where` the file: another format, cut short, not to be understood, no triangle, too many.
Soup import_triangles(const std::string& bytes, const std::string& file);

}  // namespace palpate::shapes
