// SPDX-License-Identifier: MIT
// Rotation matrices from palpate's own sine and cosine, which give the same bits on all machines.
#pragma once

#include <palpate/math.hpp>

#include <Eigen/Core>

namespace palpate {

/// Returns the matrix of the rotation by `angle`, radians, about a unit axis (Rodrigues' formula).
inline Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle) {
  const double cosine = math::cos(angle);
  Eigen::Matrix3d cross;
  cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return cosine * Eigen::Matrix3d::Identity() + math::sin(angle) * cross + (1.0 - cosine) * axis * axis.transpose();
}

}  // namespace palpate
