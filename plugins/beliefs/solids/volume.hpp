// SPDX-License-Identifier: MIT
// How much of what is solid two descriptions of it have in common: cubes over a region, by their centres.
#pragma once

#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"

#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

class Cubes {
 public:
  /// Over the ball, as far as it is above the desk. Lengths are relative to the desk.
  Cubes(const Eigen::Vector3d& centre, double radius, double side);

  /// Of each cube, whether its centre lies in a solid; column by column, each from below.
  using Held = std::vector<bool>;

  /// In an object of the scene: within its walls, not in what they enclose.
  Held of(const Scene& scene) const;
  /// In what is believed: where the assembly's distance, less what the residual GP adds, is negative. The residual GP
  /// is asked as far from the assembly's surface as it reaches, once in three cubes along each axis.
  Held of(const Assembly& solids, const ResidualGp& residual_gp) const;

 private:
  Eigen::Vector3d lowest_;  ///< centre of the first
  double side_;
  int across_, up_;
};

/// Cubes in both over cubes in either; 1 where both are empty.
double intersection_over_union(const Cubes::Held& one, const Cubes::Held& other);

}  // namespace palpate
