// SPDX-License-Identifier: MIT
// A touch in the form that the belief over solids uses.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <optional>

namespace palpate {

/// The path of a tool that moved `length` metres from the origin of its line, and ended there with or without a
/// contact. The line before the end is free, because the tool passed it.
struct SurfaceTouch {
  Line line;
  double length = 0.0;
  bool contact = false;
  bool desk = false;                        ///< a contact with the desk, not an object
  std::optional<Eigen::Vector3d> normal{};  ///< surface normal, outwards, unit length; only if the tool measures it

  Eigen::Vector3d end() const { return line.origin + length * line.direction; }
};

}  // namespace palpate
