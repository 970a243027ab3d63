// SPDX-License-Identifier: MIT
#include "solids/cloud_distances.hpp"

#include "solids/primitive.hpp"

#include <Eigen/Geometry>

#include <palpate/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace palpate {
namespace {

using Eigen::Vector3d;

std::int64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kSpan = 1 << 20;
  return ((x + kSpan / 2) * kSpan + (y + kSpan / 2)) * kSpan + (z + kSpan / 2);
}
std::array<std::int64_t, 3> cube_of(const Vector3d& point, double side) {
  std::array<std::int64_t, 3> out{};
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = static_cast<std::int64_t>(std::floor(point(static_cast<Eigen::Index>(i)) / side));
  return out;
}

constexpr double kFar = 0.1;  ///< metres: larger distances, and distances to an empty cloud, are set to this value

}  // namespace

LineBundle::LineBundle(const Vector3d& centre, double radius, int directions, double pitch) {
  for (int k = 0; k < directions; ++k) {
    // Directions on a spiral over the sphere, with equal areas.
    const double z = -1.0 + 1.5 * (k + 0.5) / directions;
    const double angle = kHalfTurn * (3.0 - std::sqrt(5.0)) * k;
    const double level = std::sqrt(1.0 - z * z);
    const Vector3d direction(level * math::cos(angle), level * math::sin(angle), z);
    const Vector3d aside = direction.unitOrthogonal();
    const Vector3d beside = direction.cross(aside);
    const int steps = static_cast<int>(radius / pitch);
    for (int i = -steps; i <= steps; ++i) {
      for (int j = -steps; j <= steps; ++j) {
        const double away = radius * radius - pitch * pitch * (i * i + j * j);
        if (away <= 0.0) continue;
        const Vector3d origin = centre + pitch * (i * aside + j * beside) - std::sqrt(away) * direction;
        if (origin.z() <= 0.0) continue;
        lines.push_back({origin, direction});
      }
    }
  }
}

Cloud thinned(const Cloud& points, double side) {
  Cloud out;
  std::unordered_set<std::int64_t> taken;
  for (const Vector3d& point : points) {
    const auto cube = cube_of(point, side);
    if (taken.insert(key_of(cube[0], cube[1], cube[2])).second) out.push_back(point);
  }
  return out;
}

std::vector<double> nearest_distances(const Cloud& from, const Cloud& to) {
  // Points within kFar of each other lie in cubes that are at most kMost apart.
  constexpr std::int64_t kMost = 10;
  constexpr double kSide = kFar / kMost;
  std::unordered_map<std::int64_t, std::vector<int>> cubes;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto cube = cube_of(to[i], kSide);
    cubes[key_of(cube[0], cube[1], cube[2])].push_back(static_cast<int>(i));
  }
  std::vector<double> out;
  out.reserve(from.size());
  for (const Vector3d& point : from) {
    const auto cube = cube_of(point, kSide);
    double least = std::numeric_limits<double>::infinity();
    for (std::int64_t ring = 0; ring <= kMost && least > kSide * static_cast<double>(ring - 1) && !to.empty(); ++ring) {
      for (std::int64_t x = -ring; x <= ring; ++x) {
        for (std::int64_t y = -ring; y <= ring; ++y) {
          const bool rim = std::abs(x) == ring || std::abs(y) == ring;
          for (std::int64_t z = -ring; z <= ring; z += rim ? 1 : std::max<std::int64_t>(1, 2 * ring)) {
            const auto found = cubes.find(key_of(cube[0] + x, cube[1] + y, cube[2] + z));
            if (found == cubes.end()) continue;
            for (const int i : found->second) least = std::min(least, (to[static_cast<std::size_t>(i)] - point).norm());
          }
        }
      }
    }
    out.push_back(least <= kFar ? least : std::numeric_limits<double>::infinity());
  }
  return out;
}

CloudErrors compare_clouds(const Cloud& belief, const Cloud& truth) {
  constexpr double kNear = 0.005;      // metres: threshold of the F-score
  constexpr double kThinning = 0.003;  // metres: avoids a larger weight where many lines meet the surface
  struct DistanceSums {
    double count = 0.0, distance = 0.0, square = 0.0, near = 0.0;
    explicit DistanceSums(const std::vector<double>& distances) : count(static_cast<double>(distances.size())) {
      for (const double one : distances) {
        const double shown = std::min(one, kFar);
        distance += shown;
        square += shown * shown;
        near += one <= kNear ? 1.0 : 0.0;
      }
    }
  };
  const DistanceSums forth(nearest_distances(thinned(belief, kThinning), truth));
  const DistanceSums back(nearest_distances(thinned(truth, kThinning), belief));
  const auto ratio = [](double part, double whole, double of_nothing) {
    return whole > 0.0 ? part / whole : of_nothing;
  };
  CloudErrors out;
  out.of_belief = ratio(forth.distance, forth.count, kFar);
  out.of_truth = ratio(back.distance, back.count, kFar);
  out.mean = ratio(forth.distance + back.distance, forth.count + back.count, 0.0);
  out.rms = std::sqrt(ratio(forth.square + back.square, forth.count + back.count, 0.0));
  out.rms_of_truth = std::sqrt(ratio(back.square, back.count, 0.0));
  const double precision = ratio(forth.near, forth.count, 0.0);
  const double recall = ratio(back.near, back.count, 0.0);
  out.f_score = ratio(2.0 * precision * recall, precision + recall, 0.0);
  return out;
}

}  // namespace palpate
