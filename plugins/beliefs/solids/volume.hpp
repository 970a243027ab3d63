// SPDX-License-Identifier: MIT
// A grid of cubes over a region, to compute the common volume of two solids. The centre of a cube decides whether the
// cube belongs to a solid.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/residual_gp.hpp"

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

class Cubes {
 public:
  /// Covers the part of the ball above the desk. Heights are relative to the desk.
  Cubes(const Eigen::Vector3d& centre, double radius, double side);

  /// One flag per cube: whether its centre lies in a solid. Cubes are ordered by columns, each from bottom to top.
  using Held = std::vector<bool>;

  /// Returns the cubes in an object of the scene: in its material, not in its hollow.
  Held of(const Scene& scene) const;
  /// Returns the cubes where the assembly's distance minus the mean of the residual GP is negative. The residual GP is
  /// evaluated only within its reach of the assembly's surface, once per three cubes along each axis.
  Held of(const Assembly& solids, const ResidualGp& residual_gp) const;

 private:
  Eigen::Vector3d lowest_;  ///< centre of the first cube
  double side_;
  int across_, up_;
};

/// Returns the number of cubes in both sets, divided by the number of cubes in at least one; 1 if both are empty.
double intersection_over_union(const Cubes::Held& one, const Cubes::Held& other);

}  // namespace palpate
