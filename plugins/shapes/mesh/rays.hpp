// SPDX-License-Identifier: MIT
// Where a line first meets a surface of triangles: the only user of Embree.
#pragma once

#include "triangles.hpp"

#include <palpate/shape.hpp>

#include <memory>

namespace palpate::shapes {

/// Safe to share between threads.
class Rays {
 public:
  explicit Rays(Triangles mesh);
  ~Rays();

  /// As Shape::first_hit. Which triangle is met is found in single precision around the middle of the mesh, within 1e-6
  /// of its size; where on that triangle is computed in double precision.
  double first_hit(const Line& line) const;

 private:
  struct Embree;

  Triangles mesh_;
  Eigen::Vector3d centre_;
  double radius_;  ///< of a ball around all points
  std::unique_ptr<Embree> embree_;
};

}  // namespace palpate::shapes
