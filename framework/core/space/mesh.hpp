// SPDX-License-Identifier: MIT
// The surface that is believed as a closed mesh: where f(x) = m(x) - g(x) of skin.hpp is 0, and the desk where an
// object stands on it.
//
// After marching cubes (Lorensen and Cline 1987), without its table: where the surface crosses the edges of a grid of
// cubes it has a vertex, exactly; in each cube the vertices are joined to rings, face by face, and two cubes join those
// on the face between them in the same way. So every edge of the mesh is shared by two triangles, whatever f does.
#pragma once

#include "space/skin.hpp"
#include "space/solids.hpp"

#include <palpate/surface.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

/// A grid of cubes with the nodes that lie within the surface, and where the surface crosses its edges: all of a mesh
/// but its triangles. Lengths in metres, relative to the desk.
struct Crossings {
  struct Vertex {
    Eigen::Vector3d at, normal;
    double deviation = 0.0;  ///< standard deviation along the normal
  };
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the first node
  double side = 0.0;                                 ///< of a cube
  std::array<int, 3> nodes{};                        ///< along x, y and z; 0 where nothing is believed in
  std::vector<std::uint8_t> inside;                  ///< 1 or 0 for each node, x fastest; 0 at the rim
  /// One for each edge with an end on either side: node by node, of each those along x, y and z that begin there.
  std::vector<Vertex> vertices;

  /// From a node to the next one along x, y and z, as they are counted.
  std::array<int, 3> strides() const { return {1, nodes[0], nodes[0] * nodes[1]}; }
  /// Whether the surface crosses an edge. Behind the last node of a row comes the first one of the next: both outside.
  bool crosses(int node, std::size_t axis) const {
    const auto one = static_cast<std::size_t>(node);
    const std::size_t other = one + static_cast<std::size_t>(strides()[axis]);
    return other < inside.size() && inside[one] != inside[other];
  }
};

/// Of the composition as `skin`, which was fitted to it, corrects it. Cubes of `side`, or, where there would be more
/// than four million, as of 2 mm over what is 31 cm wide, long and high, larger ones: Crossings::side. A wall that is
/// thinner may have holes, whose rims are closed, too. Normals are those of f; where f jumps, as at the edges of
/// pieces, those of the composition. The deviations are left to SolidsBelief, which knows all compositions.
Crossings cross_surface(const Composition& solids, const Skin& skin, double side);

/// Triangles counter-clockwise seen from outside. Rings that could share a diagonal with those of the next cube have a
/// vertex more, in their middle; these come last.
struct ClosedMesh {
  std::vector<Crossings::Vertex> vertices;
  std::vector<std::array<int, 3>> triangles;
  double side = 0.0;  ///< of the cubes
};
ClosedMesh close_mesh(const Crossings& crossings);
/// Returns the mesh in the frame of the scene; `desk`: its height, metres.
Surface surface_of(const ClosedMesh& mesh, double desk);

/// The side of the cubes of a mesh to be kept: walls of 3 mm have no holes, as long as it need not be larger.
inline constexpr double kFineSide = 0.002;

/// PLY 1.0, binary with the least byte first, for a large mesh: vertices of x, y, z, nx, ny, nz and `deviation`, as the
/// property is called, in single precision, and triangles. `comment` is one
/// line, to which the side of the cubes is added.
std::string mesh_ply(const Surface& mesh, const std::string& deviation, const std::string& comment);

}  // namespace palpate
