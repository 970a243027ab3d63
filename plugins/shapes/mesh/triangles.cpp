// SPDX-License-Identifier: MIT
#include "triangles.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate::shapes {
namespace {

using Eigen::Vector3d;

std::string text(double value) { return fmt::format("{:.4g}", value); }

/// "(1, 2, 3) mm"
std::string place(const Vector3d& point) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * point.x(), 1e3 * point.y(), 1e3 * point.z());
}

Vector3d upright(const std::array<float, 3>& corner, bool y_is_up) {
  const double x = corner[0];
  const double y = corner[1];
  const double z = corner[2];
  return y_is_up ? Vector3d(x, -z, y) : Vector3d(x, y, z);
}

void check_size(const Vector3d& extent, double furthest, double unit, const std::string& file) {
  constexpr double kLargest = 2.0;
  constexpr double kSmallest = 1e-3;
  constexpr double kPrecision = 1e-6;
  const double size = extent.maxCoeff();
  const std::string remedy = "is the unit of " + text(unit) + " m right?";
  if (size > kLargest) throw Error(file, "is " + text(size) + " m large, at most 2 m are allowed", remedy);
  if (size < kSmallest) throw Error(file, "is " + text(size) + " m large, at least 1 mm is needed", remedy);
  if (furthest * 0x1p-24 > kPrecision) {
    throw Error(file, "lies " + text(furthest) + " m from its origin, where single precision is coarser than 1e-6 m",
                "move it to the origin before it is exported");
  }
}

void check_areas(const Triangles& mesh, const std::string& file) {
  std::size_t degenerate = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    const auto& [a, b, c] = mesh.corners[i];
    const Vector3d ab = mesh.points[b] - mesh.points[a];
    const Vector3d ac = mesh.points[c] - mesh.points[a];
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    // What single precision leaves of three points on a line may be as high as its rounding.
    if (ab.cross(ac).norm() <= 0x1p-23 * longest && degenerate++ == 0) first = i;
  }
  if (degenerate == 0) return;
  throw Error(file,
              fmt::format("{} of {} triangles have no area, the first is triangle {} at {} from the middle of its base",
                          degenerate, mesh.corners.size(), first + 1, place(mesh.points[mesh.corners[first][0]])),
              "remove degenerate triangles where the mesh was made");
}

void check_doubles(const Triangles& mesh, const std::string& file) {
  std::vector<std::array<std::uint32_t, 3>> sorted = mesh.corners;
  for (auto& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice == sorted.end()) return;
  throw Error(file, "a triangle is there twice, at " + place(mesh.points[(*twice)[0]]) + " from the middle of its base",
              "remove doubled triangles where the mesh was made");
}

void check_closed(const Triangles& mesh, const std::string& file) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.corners.size());
  for (const auto& [a, b, c] : mesh.corners) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      edges.push_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  std::uint64_t first_open = 0;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t next = i;
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if (next == i + 1 && open++ == 0) first_open = edges[i];
    i = next;
  }
  if (open > 0) {
    throw Error(file,
                "has holes: " + std::to_string(open) + " edges belong to one triangle only, one from " +
                    place(mesh.points[first_open >> 32]) + " to " + place(mesh.points[first_open & 0xffffffff]) +
                    " from the middle of its base",
                "close them where the mesh was made, or write `holes: allow`");
  }
}

}  // namespace

Triangles join(const Soup& soup, const Frame& frame, const std::string& file) {
  struct Corner {
    std::array<float, 3> at;
    std::uint32_t number;
  };
  std::vector<Corner> sorted(soup.size());
  Vector3d least = Vector3d::Constant(HUGE_VAL);
  Vector3d most = -least;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    sorted[i].number = static_cast<std::uint32_t>(i);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!std::isfinite(soup[i][k])) {
        throw Error(file, "triangle " + std::to_string(i / 3 + 1) + " has a coordinate that is not a finite number",
                    "export it again");
      }
      sorted[i].at[k] = soup[i][k] + 0.0F;  // -0 is 0
    }
    const Vector3d point = upright(soup[i], frame.y_is_up);
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  check_size(frame.unit * (most - least), frame.unit * least.cwiseAbs().cwiseMax(most.cwiseAbs()).maxCoeff(),
             frame.unit, file);
  const Vector3d origin((least.x() + most.x()) / 2, (least.y() + most.y()) / 2, least.z());

  std::sort(sorted.begin(), sorted.end(),
            [](const Corner& a, const Corner& b) { return a.at != b.at ? a.at < b.at : a.number < b.number; });
  // Points keep the order in which the file names them, in which neighbours are near: see mesh.cpp.
  std::vector<std::uint32_t> first(soup.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool again = i > 0 && sorted[i].at == sorted[i - 1].at;
    first[sorted[i].number] = again ? first[sorted[i - 1].number] : sorted[i].number;
  }
  Triangles out;
  out.corners.resize(soup.size() / 3);
  std::vector<std::uint32_t> number(soup.size());
  for (std::size_t i = 0; i < soup.size(); ++i) {
    if (first[i] == i) {
      number[i] = static_cast<std::uint32_t>(out.points.size());
      out.points.emplace_back(frame.unit * (upright(soup[i], frame.y_is_up) - origin));
    }
    out.corners[i / 3][i % 3] = number[first[i]];
  }
  return out;
}

void check_surface(const Triangles& mesh, bool holes_allowed, const std::string& file) {
  check_areas(mesh, file);
  check_doubles(mesh, file);
  if (!holes_allowed) check_closed(mesh, file);
}

}  // namespace palpate::shapes
