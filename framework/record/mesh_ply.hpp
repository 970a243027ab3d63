// SPDX-License-Identifier: MIT
// Converts closed surfaces to PLY files.
#pragma once

#include <palpate/surface.hpp>

#include <string>

namespace palpate {

/// Returns a mesh as PLY 1.0 in the format binary_little_endian, which suits large meshes. Vertices have x, y, z, nx,
/// ny, nz and the standard deviation in single precision; `deviation` is the name of the last property. `comment` is
/// one line; the resolution is appended to it.
std::string mesh_ply(const Surface& mesh, const std::string& deviation, const std::string& comment);

}  // namespace palpate
