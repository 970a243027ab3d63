// SPDX-License-Identifier: MIT
// A reconstructed surface: heights at the candidates, or a closed mesh.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpate {

/// Resolution of a stored surface, metres: walls of 3 mm or more have no holes in the mesh.
inline constexpr double kFineResolution = 0.002;

/// Lengths in metres, in the frame of the scene.
struct Surface {
  /// M heights, if the candidates are fixed positions on the desk; else empty.
  Eigen::VectorXd heights;

  struct Vertex {
    Eigen::Vector3d position, normal;  ///< the normal outwards, a unit vector
    double standard_deviation = 0.0;   ///< standard deviation of the position along the normal
  };
  /// The mesh: triangles of vertices, counter-clockwise seen from outside.
  std::vector<Vertex> vertices;
  std::vector<std::array<int, 3>> triangles;
  double resolution = 0.0;  ///< edge length of the cubes from which the mesh was made
};

}  // namespace palpate
