// SPDX-License-Identifier: MIT
#include "report/contours.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// A plane with a grid of nodes. The nodes of the first and the last row and column count as outside the objects.
struct Plane {
  Vector3d origin;               ///< position of the first node, metres
  std::array<Vector3d, 2> axes;  ///< unit vectors along rows and along columns
  std::array<int, 2> nodes;      ///< number of nodes along each axis
  double side = 0.0;             ///< distance between neighbouring nodes, metres

  /// Returns the index of a node, row by row, from its column and its row.
  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(nodes[0]) + static_cast<std::size_t>(column);
  }
};

/// Returns the position of the surface between two neighbouring nodes of a grid line, as a share of their distance
/// `side`. The first node is `from` metres along the line. Returns 0.5 if no interval begins or ends between the nodes.
/// This can happen where a grid line is tangent to the surface, because the intervals along rows and along columns may
/// then disagree.
double share_between(const std::vector<LineInterval>& intervals, double from, double side) {
  for (const LineInterval& one : intervals) {
    for (const double end : {one.begin, one.end}) {
      if (end >= from && end <= from + side) return (end - from) / side;
    }
  }
  return 0.5;
}

/// Returns the ring without intermediate points that are within `most` of the straight line between the points that
/// remain.
Ring straightened(const Ring& ring, double most) {
  Ring out;
  for (std::size_t first = 0; first < ring.size();) {
    out.push_back(ring[first]);
    std::size_t last = first + 1;
    const auto is_straight = [&](std::size_t end) {
      const Eigen::ParametrizedLine<double, 3> line(ring[first], (ring[end] - ring[first]).stableNormalized());
      return std::all_of(ring.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                         ring.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](const Vector3d& point) { return line.distance(point) <= most; });
    };
    while (last + 1 < ring.size() && is_straight(last + 1)) ++last;
    first = last;
  }
  return out;
}

/// Crossings of the surface with the grid lines of a plane. The lists are empty if no row meets an object.
struct PlaneCrossings {
  std::vector<bool> inside;      ///< one flag per node: whether it is inside an object
  std::vector<Vector3d> points;  ///< on the edges from each node to the next node of its row and of its column, metres
};

/// Computes the crossings of the surface of the objects with the grid lines of `plane`.
PlaneCrossings cross_plane(const Scene& scene, const Plane& plane) {
  const std::size_t count = plane.node(0, plane.nodes[1]);
  PlaneCrossings out{std::vector<bool>(count), std::vector<Vector3d>(2 * count)};
  bool any = false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (int line = 1; line + 1 < plane.nodes[1 - axis]; ++line) {
      const Vector3d begin = plane.origin + line * plane.side * plane.axes[1 - axis];
      const std::vector<LineInterval> intervals = scene.intervals({begin, plane.axes[axis]});
      any = any || !intervals.empty();
      const auto node = [&](int k) { return axis == 0 ? plane.node(k, line) : plane.node(line, k); };
      const auto within = [&](double at) {
        return std::any_of(intervals.begin(), intervals.end(),
                           [&](const LineInterval& one) { return one.begin <= at && at <= one.end; });
      };
      for (int k = 1; axis == 0 && k + 1 < plane.nodes[0]; ++k) out.inside[node(k)] = within(k * plane.side);
      for (int k = 0; k + 1 < plane.nodes[axis]; ++k) {
        if (out.inside[node(k)] == out.inside[node(k + 1)]) continue;
        const double at = k + share_between(intervals, k * plane.side, plane.side);
        out.points[2 * node(k) + axis] =
            plane.origin + plane.side * (at * plane.axes[axis] + line * plane.axes[1 - axis]);
      }
    }
    if (!any) return {};
  }
  return out;
}

/// Adds the section of the objects by `plane` as rings, by marching squares. Each cell that the surface crosses has an
/// edge where the ring enters and an edge where it leaves. The ring then enters the neighbouring cell through the
/// shared edge.
void add_section(const Scene& scene, const Plane& plane, std::vector<Ring>& out) {
  const PlaneCrossings crossings = cross_plane(scene, plane);
  if (crossings.inside.empty()) return;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> next(crossings.points.size(), kNone);
  for (int j = 0; j + 1 < plane.nodes[1]; ++j) {
    for (int i = 0; i + 1 < plane.nodes[0]; ++i) {
      // Nodes and edges of the cell, counter-clockwise.
      const std::array<std::size_t, 4> nodes{plane.node(i, j), plane.node(i + 1, j), plane.node(i + 1, j + 1),
                                             plane.node(i, j + 1)};
      const std::array<std::size_t, 4> sides{2 * nodes[0], 2 * nodes[1] + 1, 2 * nodes[3], 2 * nodes[0] + 1};
      const auto within = [&](std::size_t k) { return crossings.inside[nodes[k % 4]]; };
      for (std::size_t k = 0; k < 4; ++k) {
        if (!within(k) || within(k + 1)) continue;
        std::size_t back = k + 1;
        while (!within(back + 1)) ++back;
        next[sides[k]] = sides[back % 4];
      }
    }
  }
  constexpr double kStraight = 0.1;
  for (std::size_t begin = 0; begin < next.size(); ++begin) {
    Ring ring;
    for (std::size_t edge = begin; next[edge] != kNone;) {
      ring.push_back(crossings.points[edge]);
      const std::size_t follows = next[edge];
      next[edge] = kNone;
      edge = follows;
    }
    if (ring.size() > 2) out.push_back(straightened(ring, kStraight * plane.side));
  }
}

}  // namespace

std::vector<Ring> contours(const Scene& scene, double apart, double side) {
  constexpr double kRadius = 0.46;  // half the width of the box, as a share of the longer side of the area
  constexpr double kHeight = 0.65;  // (height - half the width) / half the width of the box
  const Area area = scene.area();
  const double radius = kRadius * std::max(area.width, area.depth);
  const double top = (1.0 + kHeight) * radius;
  const Vector3d corner(area.width / 2 - radius, area.depth / 2 - radius, scene.desk());
  const Vector3d low = corner - Vector3d::Constant(side / 2);
  const int across = 2 + static_cast<int>(std::ceil(2.0 * radius / side));
  const int up = 2 + static_cast<int>(std::ceil(top / side));
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<Ring> out;
  for (double offset = apart / 2; offset < 2.0 * radius; offset += apart) {
    add_section(scene, {{corner.x() + offset, low.y(), low.z()}, {y, z}, {across, up}, side}, out);
    add_section(scene, {{low.x(), corner.y() + offset, low.z()}, {x, z}, {across, up}, side}, out);
  }
  for (double height = apart / 2; height < top; height += apart)
    add_section(scene, {{low.x(), low.y(), corner.z() + height}, {x, y}, {across, across}, side}, out);
  return out;
}

}  // namespace palpate
