// SPDX-License-Identifier: MIT
#include "solids/camera_rays.hpp"

#include "solids/cloud_distances.hpp"
#include "solids/primitive.hpp"

#include <Eigen/Geometry>

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double kAway = 0.6;

bool on_object(const SurfaceTouch& ray) { return ray.contact && !ray.desk; }

/// Appends `count` evenly selected rays of `from` to `out`, or all rays if there are fewer.
void take_evenly(const std::vector<SurfaceTouch>& from, std::size_t count, std::vector<SurfaceTouch>& out) {
  const std::size_t taken = std::min(count, from.size());
  for (std::size_t i = 0; i < taken; ++i) out.push_back(from[i * from.size() / taken]);
}

}  // namespace

std::vector<SurfaceTouch> side_view(const SideViewOptions& options, const Scene& scene, const Vector3d& centre,
                                    double radius, Random random) {
  const double azimuth = options.azimuth.value_or(2.0 * kHalfTurn * random.uniform());
  const Vector3d out(math::cos(azimuth) * math::cos(options.elevation),
                     math::sin(azimuth) * math::cos(options.elevation), math::sin(options.elevation));
  const Vector3d right(-math::sin(azimuth), math::cos(azimuth), 0.0);
  const Vector3d up = out.cross(right);
  const double away = std::max(kAway, 2.0 * radius);  // outside the ball, which may be large
  const Vector3d eye = centre + away * out;
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(options.rays))));
  const Vector3d desk(0.0, 0.0, scene.desk());
  std::vector<SurfaceTouch> all;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto place = [&](int i) { return radius * ((2.0 * i + 1.0) / side - 1.0); };
      const Vector3d through = centre + place(column) * right - place(row) * up;
      const Line line{eye, (through - eye).normalized()};
      const double to_desk = distance_down_to(0.0, line);
      const double hit = scene.first_intersection({line.origin + desk, line.direction});
      const double length = std::min({hit, to_desk, away + 1.5 * radius});
      all.push_back({line, length, length == hit || length == to_desk, length < hit && length == to_desk});
    }
  }
  return all;
}

bool shows_object(const std::vector<SurfaceTouch>& view) { return std::any_of(view.begin(), view.end(), on_object); }

std::vector<SurfaceTouch> thinned_view(const std::vector<SurfaceTouch>& view, std::size_t most) {
  constexpr double kSide = 0.006;
  const auto side = static_cast<std::ptrdiff_t>(std::lround(std::sqrt(static_cast<double>(view.size()))));
  const auto object_at = [&](std::ptrdiff_t row, std::ptrdiff_t column) {
    const bool within = row >= 0 && column >= 0 && row < side && column < side;
    return within && on_object(view[static_cast<std::size_t>(row * side + column)]);
  };
  Cloud ends;
  std::vector<SurfaceTouch> on, beside, others;
  for (std::ptrdiff_t row = 0; row < side; ++row) {
    for (std::ptrdiff_t column = 0; column < side; ++column) {
      const SurfaceTouch& ray = view[static_cast<std::size_t>(row * side + column)];
      const bool near = object_at(row - 1, column) || object_at(row + 1, column) || object_at(row, column - 1) ||
                        object_at(row, column + 1);
      (on_object(ray) ? on : near ? beside : others).push_back(ray);
      if (on_object(ray)) ends.push_back(ray.end());
    }
  }
  // At most three fifths of the rays end on an object and show where its surface is. At most a quarter pass next to an
  // object and show where it ends.
  std::vector<SurfaceTouch> out;
  double cube = kSide;
  Cloud kept = thinned(ends, cube);
  while (kept.size() > most * 3 / 5) kept = thinned(ends, cube *= 1.1);
  std::size_t next = 0;
  for (std::size_t i = 0; i < ends.size() && next < kept.size(); ++i) {
    if (ends[i] != kept[next]) continue;
    out.push_back(on[i]);
    ++next;
  }
  take_evenly(beside, most / 4, out);
  take_evenly(others, most - std::min(most, out.size()), out);
  return out;
}

}  // namespace palpate
