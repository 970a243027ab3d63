// SPDX-License-Identifier: MIT
// Reads a point cloud of a depth camera from a PLY file.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpate {

/// One point per column: x, y, z in the unit and the frame of the file.
using PointCloud = Eigen::Matrix3Xd;

/// Returns the finite vertices of a PLY file, ascii or binary of either byte order. Other elements are ignored. Cameras
/// write vertices that are not finite for pixels without a depth. Throws Error with `file` as its place if the bytes
/// are not a complete PLY file. Also throws if the vertices lack x, y or z, if no point is finite, or if there are more
/// than kMostPoints.
PointCloud read_points(const std::string& bytes, const std::string& file);

constexpr long kMostPoints = 20'000'000;

}  // namespace palpate
