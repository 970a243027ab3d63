// SPDX-License-Identifier: MIT
// A touch as a belief over space sees it.
#pragma once

#include <palpate/shape.hpp>

#include <Eigen/Core>

#include <optional>

namespace palpate {

/// The way of a tool that came to `length`, metres from the origin of the line, and there touched something or not. All
/// of the line before is free: the tool passed there.
struct SurfaceTouch {
  Line line;
  double length = 0.0;
  bool contact = false;
  bool desk = false;                        ///< a contact with the desk, not an object
  std::optional<Eigen::Vector3d> normal{};  ///< of the surface, outwards, of length 1: where the tool feels it

  Eigen::Vector3d end() const { return line.origin + length * line.direction; }
};

}  // namespace palpate
