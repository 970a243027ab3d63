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

/// A plane with a grid of nodes, whose first and last rows and columns count as outside.
struct Plane {
  Vector3d origin, along, up;  ///< of the first node; unit vectors to the next in a row, and in a column
  int columns = 0, rows = 0;
  double side = 0.0;

  std::vector<Stretch> row(const Scene& scene, int j) const { return scene.intervals({origin + j * side * up, along}); }
  std::vector<Stretch> column(const Scene& scene, int i) const {
    return scene.intervals({origin + i * side * along, up});
  }
};

/// Where the surface is between two nodes of a line, as a share of the way, `from` metres along it: in the middle where
/// the intervals do not tell, as those of a row and of a column may differ at what they touch.
double share_between(const std::vector<Stretch>& intervals, double from, double side) {
  for (const Stretch& one : intervals) {
    for (const double end : {one.begin, one.end}) {
      if (end >= from && end <= from + side) return (end - from) / side;
    }
  }
  return 0.5;
}

/// Without points that the line through their neighbours passes within `most`.
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

/// Cell by cell: the line comes in over one side of a cell and leaves over another,
/// and over the side between two cells it leaves the one and comes into the other.
void add_section(const Scene& scene, const Plane& plane, std::vector<Ring>& out) {
  const auto node_of = [&](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(plane.columns) + static_cast<std::size_t>(i);
  };
  const std::size_t count = node_of(0, plane.rows);
  std::vector<bool> inside(count);
  std::vector<Vector3d> crossing(2 * count);  // of the edge to the next node of the row, and of the column
  bool any = false;
  for (int j = 1; j + 1 < plane.rows; ++j) {
    const std::vector<Stretch> row = plane.row(scene, j);
    any = any || !row.empty();
    const auto within = [&](int i) {
      return std::any_of(row.begin(), row.end(),
                         [at = i * plane.side](const Stretch& one) { return one.begin <= at && at <= one.end; });
    };
    for (int i = 1; i + 1 < plane.columns; ++i) inside[node_of(i, j)] = within(i);
    for (int i = 0; i + 1 < plane.columns; ++i) {
      if (inside[node_of(i, j)] == inside[node_of(i + 1, j)]) continue;
      const double at = i + share_between(row, i * plane.side, plane.side);
      crossing[2 * node_of(i, j)] = plane.origin + plane.side * (at * plane.along + j * plane.up);
    }
  }
  if (!any) return;
  for (int i = 1; i + 1 < plane.columns; ++i) {
    const std::vector<Stretch> column = plane.column(scene, i);
    for (int j = 0; j + 1 < plane.rows; ++j) {
      if (inside[node_of(i, j)] == inside[node_of(i, j + 1)]) continue;
      const double at = j + share_between(column, j * plane.side, plane.side);
      crossing[2 * node_of(i, j) + 1] = plane.origin + plane.side * (i * plane.along + at * plane.up);
    }
  }
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> next(2 * count, kNone);
  for (int j = 0; j + 1 < plane.rows; ++j) {
    for (int i = 0; i + 1 < plane.columns; ++i) {
      // Nodes and sides counter-clockwise.
      const std::array<std::size_t, 4> nodes{node_of(i, j), node_of(i + 1, j), node_of(i + 1, j + 1),
                                             node_of(i, j + 1)};
      const std::array<std::size_t, 4> sides{2 * nodes[0], 2 * nodes[1] + 1, 2 * nodes[3], 2 * nodes[0] + 1};
      const auto within = [&](std::size_t k) { return inside[nodes[k % 4]]; };
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
      ring.push_back(crossing[edge]);
      const std::size_t follows = next[edge];
      next[edge] = kNone;
      edge = follows;
    }
    if (ring.size() > 2) out.push_back(straightened(ring, kStraight * plane.side));
  }
}

}  // namespace

std::vector<Ring> contours(const Scene& scene, double apart, double side) {
  constexpr double kRadius = 0.46;  // of the longer side of the area
  constexpr double kHeight = 0.65;  // of the centre, in radii
  const Area area = scene.area();
  const double radius = kRadius * std::max(area.width, area.depth);
  const double top = (1.0 + kHeight) * radius;
  const Vector3d corner(area.width / 2 - radius, area.depth / 2 - radius, scene.desk());
  const Vector3d low = corner - Vector3d::Constant(side / 2);
  const int across = 2 + static_cast<int>(std::ceil(2.0 * radius / side));
  const int up = 2 + static_cast<int>(std::ceil(top / side));
  std::vector<Ring> out;
  for (double offset = apart / 2; offset < 2.0 * radius; offset += apart) {
    const Vector3d x(corner.x() + offset, low.y(), low.z());
    const Vector3d y(low.x(), corner.y() + offset, low.z());
    add_section(scene, {x, Vector3d::UnitY(), Vector3d::UnitZ(), across, up, side}, out);
    add_section(scene, {y, Vector3d::UnitX(), Vector3d::UnitZ(), across, up, side}, out);
  }
  for (double height = apart / 2; height < top; height += apart)
    add_section(scene,
                {{low.x(), low.y(), corner.z() + height}, Vector3d::UnitX(), Vector3d::UnitY(), across, across, side},
                out);
  return out;
}

}  // namespace palpate
