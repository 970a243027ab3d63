// SPDX-License-Identifier: MIT
// What tests of space share: a primitive of any form, by its words a set of points; and a cup.
#pragma once

#include "solids/primitive.hpp"
#include "support/runs.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

inline Primitive random_primitive(Random& random) {
  Primitive out;
  out.form = static_cast<Primitive::Form>(random.index(3));
  out.centre = 0.05 * random_direction(random);
  out.turn = Eigen::AngleAxisd(3.0 * random.uniform(), random_direction(random)).toRotationMatrix();
  for (Eigen::Index i = 0; i < 3; ++i) out.half(i) = 0.02 + 0.05 * random.uniform();
  if (random.uniform() < 0.5) out.wall = 0.004 + 0.01 * random.uniform();
  return out;
}

/// By the words of Primitive: within the form, and not in its hollow.
inline bool holds(const Primitive& primitive, const Eigen::Vector3d& point) {
  const Eigen::Vector3d at = primitive.turn.transpose() * (point - primitive.centre);
  const auto within = [&](const Eigen::Vector3d& half, double low, double top) {
    if (at.z() < low || at.z() > top) return false;
    const double x = std::abs(at.x()) / half.x();
    const double y = std::abs(at.y()) / half.y();
    if (primitive.form == Primitive::Form::box) return x <= 1 && y <= 1;
    const double z = primitive.form == Primitive::Form::ellipsoid ? at.z() / half.z() : 0.0;
    return x * x + y * y + z * z <= 1;
  };
  const double up = primitive.half.z();
  const bool bowl = primitive.hollow() && primitive.form == Primitive::Form::ellipsoid;
  if (!within(primitive.half, -up, bowl ? 0.0 : up)) return false;
  if (!primitive.hollow()) return true;
  const Eigen::Vector3d inner = primitive.half.array() - primitive.wall;
  return bowl ? !within(inner, -inner.z(), 1.0) : !within(inner, primitive.wall - up, 1.0);
}

/// A cup: 8 cm wide, 6 cm deep, its wall 1 cm, its bottom open, in the middle of an area of 26 cm.
inline std::vector<std::string> cup() {
  return {"scene.area={width: 26 cm, depth: 26 cm}", "scene.desk=2 cm",
          "scene.objects=[{type: ring, outer: 8 cm, inner: 6 cm, height: 6 cm, at: [13 cm, 13 cm]}]"};
}
inline const Eigen::Vector3d kMiddleOfCup(0.13, 0.13, 0.08);

inline std::unique_ptr<const Scene> scene_of_cup() {
  return build_scene(shipped_config("any_side.yaml", cup()).options.scene, 1, shared_host());
}

}  // namespace palpate::test
