// SPDX-License-Identifier: MIT
// Points from a file of the format PLY, as depth cameras and their libraries write them.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpate {

/// A point a column: x, y, z in the unit and the frame of the file.
using PointCloud = Eigen::Matrix3Xd;

/// The vertices of a PLY, ascii or binary of either byte order; whatever else it holds is passed over. Points that are
/// not finite, as cameras give where they saw nothing, are left out. Throws Error, its `where` the `file`: no PLY, cut
/// short, no vertices with x, y and z, not one finite point, or more than kMostPoints.
PointCloud read_points(const std::string& bytes, const std::string& file);

constexpr long kMostPoints = 20'000'000;

}  // namespace palpate
