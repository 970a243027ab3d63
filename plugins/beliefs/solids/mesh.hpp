// SPDX-License-Identifier: MIT
// Closed mesh of the estimated surface: the zero level of f(x) = m(x) - g(x), closed by the desk where an object stands
// on it. m is the distance to the assembly, and g the mean of the residual GP (residual_gp.hpp).
//
// A variant of marching cubes (Lorensen and Cline 1987) without its table. Each grid edge that the surface crosses has
// one vertex at the crossing. In each cube, the vertices are joined face by face into rings. Two neighbouring cubes
// join the vertices of their common face in the same way, so two triangles share every edge of the mesh for any f.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/residual_gp.hpp"

#include <palpate/surface.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// A grid of cubes: its nodes inside the surface, and the crossings of the surface with its edges. Lengths are in
/// metres, heights relative to the desk. A mesh consists of these data and of triangles.
struct Crossings {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< position of the first node
  double side = 0.0;                                 ///< side of a cube
  std::array<int, 3> nodes{};                        ///< number of nodes along x, y and z; 0 without an object
  std::vector<std::uint8_t> inside;                  ///< 1 or 0 for each node, x fastest; 0 at the boundary
  /// One vertex per edge between an inner and an outer node, ordered by the first node of the edge, then by its axis.
  std::vector<Surface::Vertex> vertices;

  /// Differences of the index between a node and its neighbours along x, y and z.
  std::array<int, 3> strides() const { return {1, nodes[0], nodes[0] * nodes[1]}; }
  /// Returns whether the surface crosses an edge. The last node of a row is followed by the first of the next row; both
  /// are outside, so no crossing is found there.
  bool crosses(int node, std::size_t axis) const {
    const auto one = static_cast<std::size_t>(node);
    const std::size_t other = one + static_cast<std::size_t>(strides()[axis]);
    return other < inside.size() && inside[one] != inside[other];
  }
};

/// Returns the crossings of the surface of `solids`, corrected by `residual_gp`, which was fitted to `solids`. Cubes
/// have side `side`. If the grid would need more than four million cubes, the cubes are larger (see Crossings::side).
/// Four million cubes of 2 mm fill a cube of 31 cm. Walls thinner than a cube may have holes; the mesh is closed around
/// the holes. Normals are gradients of f; where f jumps, as at edges of primitives, the normals of the assembly replace
/// them. SolidsBelief computes the standard deviations of the vertices from all assemblies.
Crossings cross_surface(const Assembly& solids, const ResidualGp& residual_gp, double side);

/// Returns the closed mesh, with heights raised by `desk`, the desk's height in the scene, metres. A ring gets an
/// additional vertex in its middle if it could share a diagonal with a ring of the next cube. These vertices come last.
Surface close_mesh(const Crossings& crossings, double desk);

}  // namespace palpate
