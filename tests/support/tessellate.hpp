// SPDX-License-Identifier: MIT
// Closed surfaces of triangles made from the definitions of the primitives, written without their code, and the file
// formats that meshes come in. Every point lies on the solid's surface; a Shape's frame, metres.
#pragma once

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace palpate::test {

struct Surface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::size_t, 3>> triangles;

  /// The largest scalar product with a point.
  double support(const Eigen::Vector3d& direction) const;
};

/// A profile (radius, height) turned about the axis in `sides` steps; it begins and ends on the axis, or closes in
/// itself.
Surface turned(const std::vector<std::array<double, 2>>& profile, int sides);

/// What lies under `top` over the length, extruded across the width; in `steps` along the length.
Surface extruded(const std::function<double(double)>& top, double length, double width, int steps);

/// The cells between the lines at `s` and `t` whose centre is inside, raised to `height`.
Surface raised(const std::vector<double>& s, const std::vector<double>& t,
               const std::function<bool(double, double)>& inside, double height);

/// Files in millimetres.
std::string stl_text(const Surface& surface);
std::string stl_binary(const Surface& surface);
std::string obj(const Surface& surface);
std::string ply(const Surface& surface);

}  // namespace palpate::test
