// SPDX-License-Identifier: MIT
// Files of closed surfaces.
#pragma once

#include <palpate/surface.hpp>

#include <string>

namespace palpate {

/// Returns a mesh as PLY 1.0, binary with the least byte first, for a large mesh: vertices of x, y, z, nx, ny, nz and
/// `deviation`, as the property is called, in single precision, and triangles. `comment` is one line, to which the
/// resolution is added.
std::string mesh_ply(const Surface& mesh, const std::string& deviation, const std::string& comment);

}  // namespace palpate
