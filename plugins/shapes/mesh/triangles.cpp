// SPDX-License-Identifier: MIT
#include "triangles.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <boost/functional/hash.hpp>

namespace palpate::shapes {
namespace {

using Eigen::Vector3d;

std::string text(double value) { return fmt::format("{:.4g}", value); }

/// Returns a point as text: "(1, 2, 3) mm".
std::string place(const Vector3d& point) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * point.x(), 1e3 * point.y(), 1e3 * point.z());
}

Vector3d upright(const std::array<float, 3>& corner, bool y_is_up) {
  const auto [x, y, z] = corner;
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
  if (furthest * 0x1p-24 > kPrecision)
    throw Error(file, "lies " + text(furthest) + " m from its origin, where single precision has errors above 1e-6 m",
                "move it to the origin before the export");
}

void check_areas(const Triangles& mesh, const std::string& file) {
  std::size_t degenerate = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    const auto& [a, b, c] = mesh.corners[i];
    const Vector3d ab = mesh.points[b] - mesh.points[a];
    const Vector3d ac = mesh.points[c] - mesh.points[a];
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    // Single precision may move a point off a line by a rounding error. Smaller heights of a triangle therefore count
    // as 0.
    if (ab.cross(ac).norm() <= 0x1p-23 * longest && degenerate++ == 0) first = i;
  }
  if (degenerate == 0) return;
  throw Error(file,
              fmt::format("{} of {} triangles have no area, the first is triangle {} at {} from the middle of its base",
                          degenerate, mesh.corners.size(), first + 1, place(mesh.points[mesh.corners[first][0]])),
              "remove degenerate triangles in the program that made the mesh");
}

void check_doubles(const Triangles& mesh, const std::string& file) {
  std::vector<std::array<std::uint32_t, 3>> sorted = mesh.corners;
  for (auto& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice == sorted.end()) return;
  throw Error(file, "a triangle occurs twice, at " + place(mesh.points[(*twice)[0]]) + " from the middle of its base",
              "remove duplicate triangles in the program that made the mesh");
}

void check_closed(const Triangles& mesh, const std::string& file) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.corners.size());
  for (const auto& [a, b, c] : mesh.corners) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      edges.push_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to));
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
  if (open > 0)
    throw Error(file,
                "has holes: " + std::to_string(open) + " edges belong to one triangle only, one from " +
                    place(mesh.points[first_open >> 32]) + " to " + place(mesh.points[first_open & 0xffffffff]) +
                    " from the middle of its base",
                "close them in the program that made the mesh, or write `holes: allow`");
}

/// The points keep the order of the file, in which neighbours are close to each other. The boxes in mesh.cpp rely on
/// this.
Triangles join(const Soup& soup, const MeshOptions& options) {
  const bool y_is_up = options.up == MeshOptions::Up::y;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const Vector3d point = upright(soup[i], y_is_up);
    if (!point.allFinite())
      throw Error(options.file,
                  "triangle " + std::to_string(i / 3 + 1) + " has a coordinate that is not a finite number",
                  "export it again");
    box.extend(point);
  }
  const double furthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  check_size(options.unit * box.sizes(), options.unit * furthest, options.unit, options.file);
  const Vector3d origin(box.center().x(), box.center().y(), box.min().z());

  Triangles out;
  out.corners.resize(soup.size() / 3);
  std::unordered_map<Soup::value_type, std::uint32_t, boost::hash<Soup::value_type>> numbers;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const auto [x, y, z] = soup[i];
    const auto next = static_cast<std::uint32_t>(out.points.size());
    const auto [known, fresh] = numbers.try_emplace({x + 0.0F, y + 0.0F, z + 0.0F}, next);  // adding 0 turns -0 into 0
    if (fresh) out.points.emplace_back(options.unit * (upright(soup[i], y_is_up) - origin));
    out.corners[i / 3][i % 3] = known->second;
  }
  return out;
}

}  // namespace

Triangles read_surface(const MeshOptions& options) {
  const Triangles out = join(import_triangles(read_file(options.file, options.checksum), options.file), options);
  check_areas(out, options.file);
  check_doubles(out, options.file);
  if (options.holes == MeshOptions::Holes::refuse) check_closed(out, options.file);
  return out;
}

}  // namespace palpate::shapes
