// SPDX-License-Identifier: MIT
#include "solids/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// The function f of mesh.hpp: 0 on the estimated surface, negative inside. The residual GP is evaluated only near the
/// assembly's surface; further away it cannot change the sign of f. Evaluation in batches is faster.
class SignedSurface {
 public:
  SignedSurface(const Assembly& solids, const ResidualGp& residual_gp)
      : solids_(solids), residual_gp_(residual_gp), most_(residual_gp.reach()) {}

  /// Returns the largest distance between the surfaces of the assembly and of the belief, metres.
  double most() const { return most_; }

  /// Returns f at positions with these distances to the assembly. The desk is ignored.
  std::vector<double> values(const std::vector<Vector3d>& at, std::vector<double> distances) const {
    ResidualGp::Places places;
    std::vector<std::size_t> whose;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (!(std::abs(distances[i]) <= most_)) continue;
      places.push_back({at[i], solids_.normal(at[i])});
      whose.push_back(i);
    }
    const Eigen::VectorXd means = residual_gp_.means(places);
    for (std::size_t i = 0; i < whose.size(); ++i) distances[whose[i]] -= means(static_cast<Eigen::Index>(i));
    return distances;
  }
  std::vector<double> values(const std::vector<Vector3d>& at) const {
    std::vector<double> distances;
    for (const Vector3d& one : at) distances.push_back(solids_.distance(one));
    return values(at, std::move(distances));
  }

  /// Returns the surface normals at points of the surface: gradients of f from differences at the corners of a
  /// tetrahedron.
  std::vector<Vector3d> normals(const std::vector<Vector3d>& at) const {
    constexpr double kStep = 1e-5;
    // The gradient of a distance has length 1, and the gradient of the residual GP is shorter. A longer difference
    // quotient is not a gradient: f jumps there, because the assembly's normal jumps.
    constexpr double kSteepest = 3.0;
    static const std::array<Vector3d, 4> corners{Vector3d(1, -1, -1), Vector3d(-1, -1, 1), Vector3d(-1, 1, -1),
                                                 Vector3d(1, 1, 1)};
    std::vector<Vector3d> around;
    for (const Vector3d& one : at) {
      for (const Vector3d& corner : corners) around.emplace_back(one + kStep * corner);
    }
    const std::vector<double> found = values(around);
    std::vector<Vector3d> out;
    for (std::size_t i = 0; i < at.size(); ++i) {
      constexpr double kOnDesk = 1e-6;
      Vector3d slope = Vector3d::Zero();
      for (std::size_t k = 0; k < corners.size(); ++k) slope += found[4 * i + k] / (4.0 * kStep) * corners[k];
      const double steepness = slope.norm();
      const bool smooth = steepness > 1.0 / kSteepest && steepness < kSteepest;
      out.push_back(at[i].z() < kOnDesk ? Vector3d(-Vector3d::UnitZ())
                    : smooth            ? Vector3d(slope / steepness)
                                        : solids_.normal(at[i]));
    }
    return out;
  }

 private:
  const Assembly& solids_;
  const ResidualGp& residual_gp_;
  double most_;
};

struct Box {
  Eigen::Array3d low = Eigen::Array3d::Constant(kNoHit);
  Eigen::Array3d high = Eigen::Array3d::Constant(-kNoHit);
};
Box box_of(const Primitive& primitive, double margin) {
  const Vector3d reach = primitive.turn.cwiseAbs() * primitive.half;
  return {(primitive.centre - reach).array() - margin, (primitive.centre + reach).array() + margin};
}

/// Cuts the solid off at the desk.
double above_desk(double value, const Vector3d& at) { return std::max(value, -at.z()); }

/// A grid edge from a node to the next one, with one end inside the surface, and the state of the search for the zero
/// of f on it.
struct Edge {
  Vector3d from;
  Eigen::Index axis;
  double at_low, at_high;  ///< f at both ends; may be infinite far from the surface
  double low = 0.0, high = 1.0, share = 0.5;
  bool done = false;

  Vector3d at(double part, double side) const { return from + part * side * Vector3d::Unit(axis); }
};

/// Returns the zero of f on each edge. It is moved at least kRim of the edge's length away from both ends, where
/// vertices of several edges would coincide.
std::vector<Vector3d> roots(const SignedSurface& field, std::vector<Edge> edges, double side) {
  constexpr double kRim = 0.01;
  constexpr double kExact = 1e-6;
  constexpr int kSteps = 24;
  for (int step = 0; step < kSteps; ++step) {
    std::vector<Edge*> some;
    std::vector<Vector3d> places;
    for (Edge& one : edges) {
      if (one.done) continue;
      // Alternates secant and bisection steps, because f has kinks, and jumps where normals jump.
      const bool secant = step % 2 == 0 && std::abs(one.at_low) < kNoHit && std::abs(one.at_high) < kNoHit;
      one.share = secant ? one.low + (one.high - one.low) * one.at_low / (one.at_low - one.at_high)
                         : 0.5 * (one.low + one.high);
      some.push_back(&one);
      places.push_back(one.at(one.share, side));
    }
    if (some.empty()) break;
    const std::vector<double> found = field.values(places);
    for (std::size_t i = 0; i < some.size(); ++i) {
      Edge& one = *some[i];
      const double value = above_desk(found[i], places[i]);
      one.done = std::abs(value) < kExact;
      ((value < 0.0) == (one.at_low < 0.0) ? one.low : one.high) = one.share;
      ((value < 0.0) == (one.at_low < 0.0) ? one.at_low : one.at_high) = value;
    }
  }
  std::vector<Vector3d> out;
  for (const Edge& one : edges) out.push_back(one.at(std::clamp(one.share, kRim, 1.0 - kRim), side));
  return out;
}

/// The eight nodes of a cube are numbered along x, then y, then z; an edge has a first node and one of three axes. Each
/// face lists its nodes counter-clockwise, seen from outside the cube.
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
constexpr std::size_t kEdges = 24;
std::size_t edge_between(int one, int other) {
  const int axis = (one ^ other) >> 1;  // 0, 1, 2 for x, y, z
  const int edge = 8 * axis + (one & other);
  return static_cast<std::size_t>(edge);
}

/// The rings of vertices of a cube, computed from its inner nodes. `next` maps each edge with a vertex to the next edge
/// of its ring, counter-clockwise seen from outside the solid, and all other edges to -1. `crowded` marks edges on a
/// face with four vertices.
struct Rings {
  std::array<int, kEdges> next{};
  std::array<bool, kEdges> crowded{};

  explicit Rings(unsigned inside) {
    next.fill(-1);
    const auto in = [&](int node) { return (inside >> static_cast<unsigned>(node) & 1U) != 0; };
    for (const std::array<int, 4>& face : kFaces) {
      const auto node = [&](std::size_t k) { return face[k % 4]; };
      std::size_t leaves = 0;
      for (std::size_t k = 0; k < 4; ++k) leaves += in(node(k)) && !in(node(k + 1)) ? 1 : 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (!in(node(k)) || in(node(k + 1))) continue;
        // The ring goes around the outer nodes: two inner nodes at opposite corners of a face count as connected.
        std::size_t back = k + 1;
        while (!in(node(back + 1))) ++back;
        const std::size_t leave = edge_between(node(k), node(k + 1));
        const std::size_t enter = edge_between(node(back), node(back + 1));
        next[enter] = static_cast<int>(leave);
        if (leaves == 2) crowded[leave] = crowded[enter] = true;
      }
    }
  }
};

/// Returns the distance from each node to the assembly; may be infinity for distances above `most`.
std::vector<double> distances_at(const Crossings& grid, const Assembly& solids, double most) {
  const std::array<int, 3> strides = grid.strides();
  std::vector<double> out(static_cast<std::size_t>(strides[2]) * static_cast<std::size_t>(grid.nodes[2]), kNoHit);
  for (const Assembly::Part& part : solids.parts) {
    const Box box = box_of(part.primitive, most);
    const auto index = [&](const Eigen::Array3d& end, std::size_t axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      return std::clamp(static_cast<int>(std::ceil((end(i) - grid.origin(i)) / grid.side)), 0, grid.nodes[axis]);
    };
    for (int z = index(box.low, 2); z < index(box.high, 2); ++z) {
      for (int y = index(box.low, 1); y < index(box.high, 1); ++y) {
        for (int x = index(box.low, 0); x < index(box.high, 0); ++x) {
          const int node = x + strides[1] * y + strides[2] * z;
          double& least = out[static_cast<std::size_t>(node)];
          least = std::min(least, part.primitive.distance(grid.origin + grid.side * Vector3d(x, y, z)));
        }
      }
    }
  }
  return out;
}

/// Returns a grid around the part of the assembly above the desk, enlarged by `margin` metres, without crossings. The
/// grid has no nodes if there is no such part. Its cubes have side `side` or larger, metres.
Crossings make_empty_grid(const Assembly& solids, double margin, double side) {
  constexpr double kMostNodes = 4e6;
  Crossings out;
  Box all;
  for (const Assembly::Part& part : solids.parts) {
    const Box one = box_of(part.primitive, margin);
    all.low = all.low.min(one.low);
    all.high = all.high.max(one.high);
  }
  all.low.z() = 0.0;
  if (!(all.high > all.low).all()) return out;
  for (const Eigen::Array3d extent = all.high - all.low; (extent / side + 4.0).prod() > kMostNodes;) side *= 1.1;
  // The grid has one more layer of nodes around this box. Its lowest nodes are half a cube below the desk, so no node
  // lies on the desk.
  out.side = side;
  out.origin = all.low - 1.5 * side;
  out.origin.z() = -0.5 * side;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    out.nodes[i] = 2 + static_cast<int>(std::ceil((all.high(axis) - out.origin(axis)) / side));
  }
  return out;
}

/// Returns the edges that the surface crosses, in the order of their vertices. `f` has one value per node.
std::vector<Edge> find_crossed_edges(const Crossings& grid, const std::vector<double>& f) {
  const auto [nx, ny, nz] = grid.nodes;
  std::vector<Edge> out;
  for (int i = 0; i < static_cast<int>(grid.inside.size()); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!grid.crosses(i, axis)) continue;
      const auto node = static_cast<std::size_t>(i);
      const auto next = node + static_cast<std::size_t>(grid.strides()[axis]);
      const Eigen::Vector3i at(i % nx, i / nx % ny, i / (nx * ny));
      out.push_back({grid.origin + grid.side * at.cast<double>(), static_cast<Eigen::Index>(axis), f[node], f[next]});
    }
  }
  return out;
}

/// Adds the triangles of a ring of vertices to `mesh`, all around one vertex. If the ring is `crowded` and has more
/// than three vertices, this is an additional vertex in its middle, else its first vertex.
void add_ring(const std::vector<int>& ring, bool crowded, Surface& mesh) {
  if (!crowded || ring.size() <= 3) {
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) mesh.triangles.push_back({ring[0], ring[i], ring[i + 1]});
    return;
  }
  Surface::Vertex middle{Vector3d::Zero(), Vector3d::Zero(), 0.0};
  for (const int i : ring) {
    const Surface::Vertex& one = mesh.vertices[static_cast<std::size_t>(i)];
    middle.position += one.position / static_cast<double>(ring.size());
    middle.normal += one.normal;
    middle.standard_deviation += one.standard_deviation / static_cast<double>(ring.size());
  }
  middle.normal.normalize();
  const auto hub = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(middle);
  for (std::size_t i = 0; i < ring.size(); ++i) mesh.triangles.push_back({hub, ring[i], ring[(i + 1) % ring.size()]});
}

}  // namespace

Crossings cross_surface(const Assembly& solids, const ResidualGp& residual_gp, double side) {
  const SignedSurface field(solids, residual_gp);
  Crossings out = make_empty_grid(solids, field.most(), side);
  if (out.nodes[0] == 0) return out;
  const auto [nx, ny, nz] = out.nodes;
  const std::array<int, 3> strides = out.strides();
  // Nodes far from all primitives have distance infinity and are outside.
  std::vector<double> f = distances_at(out, solids, field.most() + out.side);
  out.inside.resize(f.size());
  std::vector<Vector3d> layer;
  for (int z = 0; z < nz; ++z) {
    layer.clear();
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) layer.emplace_back(out.origin + out.side * Vector3d(x, y, z));
    }
    const auto begin = f.begin() + static_cast<std::ptrdiff_t>(z) * strides[2];
    const std::vector<double> values = field.values(layer, {begin, begin + strides[2]});
    std::transform(values.begin(), values.end(), layer.begin(), begin, above_desk);
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        const bool rim = x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny || z + 1 == nz;
        const int number = x + strides[1] * y + strides[2] * z;
        const auto node = static_cast<std::size_t>(number);
        out.inside[node] = !rim && f[node] < 0.0;
      }
    }
  }
  const std::vector<Vector3d> ends = roots(field, find_crossed_edges(out, f), out.side);
  const std::vector<Vector3d> normals = field.normals(ends);
  for (std::size_t i = 0; i < ends.size(); ++i) out.vertices.push_back({ends[i], normals[i], 0.0});
  return out;
}

Surface close_mesh(const Crossings& crossings, double desk) {
  Surface out{{}, crossings.vertices, {}, crossings.side};
  const std::array<int, 3> strides = crossings.strides();
  std::array<int, 8> corners{};
  for (int i = 0; i < 8; ++i)
    corners[static_cast<std::size_t>(i)] = (i & 1) + strides[1] * (i >> 1 & 1) + strides[2] * (i >> 2);
  // Index of the vertex on the edge from each node along each axis; 0 for edges without a vertex.
  std::vector<int> vertices(3 * crossings.inside.size());
  int count = 0;
  for (std::size_t edge = 0; edge < vertices.size(); ++edge)
    if (crossings.crosses(static_cast<int>(edge / 3), edge % 3)) vertices[edge] = count++;
  // A cube has the number of its first node. The last node of a row begins no cube. The eight nodes that its number
  // gives are all at the boundary, and so outside.
  for (int cube = 0; cube + corners[7] < static_cast<int>(crossings.inside.size()); ++cube) {
    unsigned inside = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const int node = cube + corners[i];
      inside |= unsigned{crossings.inside[static_cast<std::size_t>(node)]} << i;
    }
    if (inside == 0 || inside == 255) continue;
    const Rings rings(inside);
    std::array<bool, kEdges> done{};
    for (std::size_t begin = 0; begin < kEdges; ++begin) {
      if (rings.next[begin] < 0 || done[begin]) continue;
      std::vector<int> ring;
      bool crowded = false;
      for (std::size_t edge = begin; !done[edge]; edge = static_cast<std::size_t>(rings.next[edge])) {
        done[edge] = true;
        crowded = crowded || rings.crowded[edge];
        const int node = cube + corners[edge % 8];
        ring.push_back(vertices[3 * static_cast<std::size_t>(node) + edge / 8]);
      }
      add_ring(ring, crowded, out);
    }
  }
  for (Surface::Vertex& one : out.vertices) one.position += Vector3d(0.0, 0.0, desk);
  return out;
}

}  // namespace palpate
