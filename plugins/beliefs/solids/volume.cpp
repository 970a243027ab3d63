// SPDX-License-Identifier: MIT
#include "solids/volume.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace palpate {

using Eigen::Vector3d;

Cubes::Cubes(const Vector3d& centre, double radius, double side)
    : lowest_(centre.x() - radius + side / 2, centre.y() - radius + side / 2, side / 2),
      side_(side),
      across_(static_cast<int>(std::ceil(2.0 * radius / side))),
      up_(static_cast<int>(std::ceil((centre.z() + radius) / side))) {}

Cubes::Held Cubes::of(const Scene& scene) const {
  Held out(static_cast<std::size_t>(across_) * static_cast<std::size_t>(across_) * static_cast<std::size_t>(up_));
  std::size_t column = 0;
  for (int i = 0; i < across_; ++i) {
    for (int k = 0; k < across_; ++k, column += static_cast<std::size_t>(up_)) {
      const Line line{lowest_ + Vector3d(i * side_, k * side_, scene.desk()), Vector3d::UnitZ()};
      for (const LineInterval& stretch : scene.intervals(line)) {
        const int last = std::min(up_ - 1, static_cast<int>(std::floor(stretch.end / side_)));
        for (int n = std::max(0, static_cast<int>(std::ceil(stretch.begin / side_))); n <= last; ++n)
          out[column + static_cast<std::size_t>(n)] = true;
      }
    }
  }
  return out;
}

namespace {

struct NearestPrimitive {
  double distance = kNoHit;   ///< distance to the assembly
  double clear = kNoHit;      ///< lower bound of the distance to any surface
  std::size_t primitive = 0;  ///< index of the primitive with this distance
};

/// Returns a lower bound of the ratio of true distance to Primitive::distance(). For round primitives with unequal half
/// extents, that function is too large between the axes.
double certain_share(const Primitive& primitive) {
  if (primitive.form == Primitive::Form::box) return 1.0;
  if (primitive.form == Primitive::Form::cylinder && primitive.half.x() == primitive.half.y()) return 1.0;
  const auto axes = primitive.form == Primitive::Form::cylinder ? primitive.half.head(2) : primitive.half.head(3);
  return std::max(1e-4, axes.minCoeff() - primitive.wall) / axes.maxCoeff();
}

Vector3d normal(const Primitive& primitive, const Vector3d& at) {
  constexpr double kStep = 1e-5;
  Vector3d out;
  for (Eigen::Index i = 0; i < 3; ++i)
    out(i) = primitive.distance(at + kStep * Vector3d::Unit(i)) - primitive.distance(at - kStep * Vector3d::Unit(i));
  return out.stableNormalized();
}

/// Finds the nearest primitive of an assembly.
class PrimitiveSearch {
 public:
  explicit PrimitiveSearch(const Assembly& solids) : solids_(solids) {
    for (const Assembly::Part& part : solids.parts) {
      shares_.push_back(certain_share(part.primitive));
      balls_.push_back(part.primitive.form == Primitive::Form::ellipsoid ? part.primitive.half.maxCoeff()
                                                                         : part.primitive.half.norm());
    }
  }

  /// Returns the nearest primitive to a point, with distances in metres.
  NearestPrimitive find(const Vector3d& at) const {
    NearestPrimitive known;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      const Primitive& primitive = solids_.parts[i].primitive;
      const double distance = primitive.distance(at);
      const double to_ball = (at - primitive.centre).norm() - balls_[i];
      const double clear = std::max(shares_[i] * std::abs(distance), to_ball);
      // from inside several primitives, the surface is outside all of them: the largest bound counts
      if (distance < 0.0) {
        known.clear = known.distance < 0.0 ? std::max(known.clear, clear) : clear;
      } else if (known.distance >= 0.0) {
        known.clear = std::min(known.clear, clear);
      }
      if (distance < known.distance) known.distance = distance, known.primitive = i;
    }
    return known;
  }

 private:
  const Assembly& solids_;
  std::vector<double> shares_, balls_;  ///< see certain_share(); radii of balls around the primitives, metres
};

/// Mean of the residual GP, which changes slowly. It is evaluated once per block of kCubes^3 cubes, separately for each
/// primitive and each of six directions of the normal. Neighbouring primitives may have parallel surfaces with
/// different means.
class ResidualMeanCache {
 public:
  ResidualMeanCache(const ResidualGp& residual_gp, double side) : residual_gp_(residual_gp), side_(kCubes * side) {}

  double mean(std::size_t which, const Primitive& primitive, const Vector3d& at) {
    const Vector3d facing = normal(primitive, at);
    Eigen::Index axis = 0;
    facing.cwiseAbs().maxCoeff(&axis);
    const auto place = [&](Eigen::Index i) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(at(i) / side_)) + (1 << (kBits - 1)));
    };
    const auto face = static_cast<std::uint64_t>(2 * axis + (facing(axis) < 0.0 ? 1 : 0));
    const std::uint64_t key = (((which << kBits | place(0)) << kBits | place(1)) << kBits | place(2)) << 3 | face;
    const auto [found, is_new] = means_.try_emplace(key, 0.0);
    if (is_new) found->second = residual_gp_.mean({at, facing});
    return found->second;
  }

 private:
  static constexpr int kCubes = 3;
  static constexpr unsigned kBits = 16;  // leaves 13 bits for primitives, of which there are at most seven
  const ResidualGp& residual_gp_;
  double side_;
  std::unordered_map<std::uint64_t, double> means_;
};

}  // namespace

Cubes::Held Cubes::of(const Assembly& solids, const ResidualGp& residual_gp) const {
  Held out(static_cast<std::size_t>(across_) * static_cast<std::size_t>(across_) * static_cast<std::size_t>(up_));
  const double band = residual_gp.reach();
  ResidualMeanCache nearby(residual_gp, side_);
  const PrimitiveSearch nearest(solids);
  // Subdivides blocks of cubes until the surface is farther from their centre than their corners are.
  const auto fill = [&](const auto& self, int x, int y, int z, int size) -> void {
    if (x >= across_ || y >= across_ || z >= up_) return;
    const Vector3d at = lowest_ + side_ * (Vector3d(x, y, z) + Vector3d::Constant(0.5 * (size - 1)));
    const NearestPrimitive found = nearest.find(at);
    if (size > 1 && found.clear <= band + 0.5 * std::sqrt(3.0) * (size - 1) * side_) {
      const int half = size / 2;
      for (int part = 0; part < 8; ++part)
        self(self, x + (part & 1) * half, y + (part >> 1 & 1) * half, z + (part >> 2) * half, half);
      return;
    }
    const bool near = size == 1 && std::abs(found.distance) < band;
    if (!(found.distance - (near ? nearby.mean(found.primitive, solids.parts[found.primitive].primitive, at) : 0.0) <
          0.0))
      return;
    for (int i = x; i < std::min(across_, x + size); ++i) {
      for (int k = y; k < std::min(across_, y + size); ++k) {
        const std::size_t column =
            (static_cast<std::size_t>(i) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(k)) *
            static_cast<std::size_t>(up_);
        for (int n = z; n < std::min(up_, z + size); ++n) out[column + static_cast<std::size_t>(n)] = true;
      }
    }
  };
  constexpr int kBlock = 16;
  for (int x = 0; x < across_; x += kBlock) {
    for (int y = 0; y < across_; y += kBlock) {
      for (int z = 0; z < up_; z += kBlock) fill(fill, x, y, z, kBlock);
    }
  }
  return out;
}

double intersection_over_union(const Cubes::Held& one, const Cubes::Held& other) {
  std::size_t both = 0;
  std::size_t either = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    both += one[i] && other[i] ? 1 : 0;
    either += one[i] || other[i] ? 1 : 0;
  }
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 1.0;
}

}  // namespace palpate
