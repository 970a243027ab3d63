// SPDX-License-Identifier: MIT
#include "space/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// f, of which the skin has a say near the composition's surface alone: further away it changes no sign.
class SignedSurface {
 public:
  SignedSurface(const Composition& solids, const Skin& skin, const std::vector<SurfaceTouch>& touches)
      : solids_(solids), skin_(skin) {
    constexpr double kMore = 0.001;
    for (const SurfaceTouch& touch : touches) {
      const double off = touch.contact && !touch.desk ? std::abs(solids_.distance(touch.end())) : 0.0;
      if (off <= kFarthest) most_ = std::max(most_, off + kMore);
    }
  }

  /// How far off the composition's surface that of the belief may be.
  double most() const { return most_; }

  /// At a place with this distance from the composition.
  double value(const Vector3d& at, double distance) const {
    if (std::abs(distance) <= most_) distance -= skin_.mean({at, Skin::normal(solids_, at)});
    return std::max(distance, -at.z());
  }
  double operator()(const Vector3d& at) const { return value(at, solids_.distance(at)); }

  Crossings::Vertex vertex(const Vector3d& at) const {
    constexpr double kOnDesk = 1e-6;
    const Vector3d normal = Skin::normal(solids_, at);
    return {at, at.z() < kOnDesk ? Vector3d(-Vector3d::UnitZ()) : normal, 0.0};
  }

 private:
  static constexpr double kFarthest = 0.012;  // what is further off is not the skin's
  const Composition& solids_;
  const Skin& skin_;
  double most_ = 0.0;
};

struct Box {
  Eigen::Array3d low = Eigen::Array3d::Constant(kNoHit);
  Eigen::Array3d high = Eigen::Array3d::Constant(-kNoHit);
};
Box box_of(const Piece& piece, double margin) {
  const Vector3d reach = piece.turn.cwiseAbs() * piece.half;
  return {(piece.centre - reach).array() - margin, (piece.centre + reach).array() + margin};
}

/// Where f is 0 between a node and the next one along an axis, of which one lies inside. Never at an end, where
/// vertices of several edges would fall together.
Vector3d root(const SignedSurface& field, const Vector3d& from, Eigen::Index axis, double side) {
  constexpr double kRim = 0.01;
  constexpr double kExact = 1e-6;
  constexpr int kSteps = 24;
  const auto at = [&](double share) { return Vector3d(from + share * side * Vector3d::Unit(axis)); };
  double low = 0.0, high = 1.0;
  double at_low = field(at(low)), at_high = field(at(high));
  double share = 0.5;
  for (int i = 0; i < kSteps; ++i) {
    // Between the two by the secant, then in their middle: f has kinks, and jumps where normals do.
    const bool secant = i % 2 == 0 && (at_low < 0.0) != (at_high < 0.0);
    share = secant ? low + (high - low) * at_low / (at_low - at_high) : 0.5 * (low + high);
    const double value = field(at(share));
    if (std::abs(value) < kExact) break;
    ((value < 0.0) == (at_low < 0.0) ? low : high) = share;
    ((value < 0.0) == (at_low < 0.0) ? at_low : at_high) = value;
  }
  return at(std::clamp(share, kRim, 1.0 - kRim));
}

/// The eight nodes of a cube are counted along x, then y, then z; an edge is one of three axes from one of them. Of
/// each face the nodes counter-clockwise, seen from outside the cube.
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
constexpr std::size_t kEdges = 24;
std::size_t edge_between(int one, int other) {
  const int axis = (one ^ other) >> 1;  // 0, 1, 2 for x, y, z
  const int edge = 8 * axis + (one & other);
  return static_cast<std::size_t>(edge);
}

/// The rings of a cube by the nodes inside: of each edge with a vertex the next one around, outside to the front, -1 of
/// one without; and which edges lie on a face with four of them.
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
        // Around what lies outside: where two nodes inside are across from each other, they are one.
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

/// The distance from each node to the composition; infinity, maybe, where that is more than `most`.
std::vector<double> distances_at(const Crossings& grid, const Composition& solids, double most) {
  const std::array<int, 3> strides = grid.strides();
  std::vector<double> out(static_cast<std::size_t>(strides[2]) * static_cast<std::size_t>(grid.nodes[2]), kNoHit);
  for (const Composition::Part& part : solids.parts) {
    const Box box = box_of(part.piece, most);
    const auto index = [&](const Eigen::Array3d& end, std::size_t axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      return std::clamp(static_cast<int>(std::ceil((end(i) - grid.origin(i)) / grid.side)), 0, grid.nodes[axis]);
    };
    for (int z = index(box.low, 2); z < index(box.high, 2); ++z) {
      for (int y = index(box.low, 1); y < index(box.high, 1); ++y) {
        for (int x = index(box.low, 0); x < index(box.high, 0); ++x) {
          const int node = x + strides[1] * y + strides[2] * z;
          double& least = out[static_cast<std::size_t>(node)];
          least = std::min(least, part.piece.distance(grid.origin + grid.side * Vector3d(x, y, z)));
        }
      }
    }
  }
  return out;
}

}  // namespace

Crossings cross_surface(const Composition& solids, const Skin& skin, const std::vector<SurfaceTouch>& touches,
                        double side) {
  constexpr double kMostNodes = 4e6;
  const SignedSurface field(solids, skin, touches);
  Crossings out;
  Box all;
  for (const Composition::Part& part : solids.parts) {
    const Box one = box_of(part.piece, field.most());
    all.low = all.low.min(one.low);
    all.high = all.high.max(one.high);
  }
  all.low.z() = 0.0;
  if (!(all.high > all.low).all()) return out;
  for (const Eigen::Array3d extent = all.high - all.low; (extent / side + 4.0).prod() > kMostNodes;) side *= 1.1;
  // Around it a node more; of those below the desk none lies on it.
  out.side = side;
  out.origin = all.low - 1.5 * side;
  out.origin.z() = -0.5 * side;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    out.nodes[i] = 2 + static_cast<int>(std::ceil((all.high(axis) - out.origin(axis)) / side));
  }
  const auto [nx, ny, nz] = out.nodes;
  const std::array<int, 3> strides = out.strides();
  const auto place = [&](int x, int y, int z) { return Vector3d(out.origin + side * Vector3d(x, y, z)); };

  const std::vector<double> distances = distances_at(out, solids, field.most() + side);
  out.inside.resize(distances.size());
  std::size_t node = 0;
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x, ++node) {
        const bool rim = x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny || z + 1 == nz;
        out.inside[node] = !rim && distances[node] < kNoHit && field.value(place(x, y, z), distances[node]) < 0.0;
      }
    }
  }
  for (int i = 0; i < static_cast<int>(out.inside.size()); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!out.crosses(i, axis)) continue;
      const Vector3d at = place(i % nx, i / nx % ny, i / strides[2]);
      out.vertices.push_back(field.vertex(root(field, at, static_cast<Eigen::Index>(axis), side)));
    }
  }
  return out;
}

ClosedMesh close_mesh(const Crossings& crossings) {
  ClosedMesh out{crossings.vertices, {}};
  const std::array<int, 3> strides = crossings.strides();
  std::array<int, 8> corners{};
  for (int i = 0; i < 8; ++i)
    corners[static_cast<std::size_t>(i)] = (i & 1) + strides[1] * (i >> 1 & 1) + strides[2] * (i >> 2);
  std::vector<int> first;  // vertex of each node
  first.reserve(crossings.inside.size());
  int count = 0;
  for (int node = 0; node < static_cast<int>(crossings.inside.size()); ++node) {
    first.push_back(count);
    for (std::size_t axis = 0; axis < 3; ++axis) count += crossings.crosses(node, axis) ? 1 : 0;
  }
  for (int z = 0; z + 1 < crossings.nodes[2]; ++z) {
    for (int y = 0; y + 1 < crossings.nodes[1]; ++y) {
      for (int x = 0; x + 1 < crossings.nodes[0]; ++x) {
        const int cube = x + strides[1] * y + strides[2] * z;
        unsigned inside = 0;
        for (unsigned i = 0; i < 8; ++i) {
          const int node = cube + corners[i];
          inside |= unsigned{crossings.inside[static_cast<std::size_t>(node)]} << i;
        }
        if (inside == 0 || inside == 255) continue;
        const Rings rings(inside);
        const auto vertex_of = [&](std::size_t edge) {
          const int node = cube + corners[edge % 8];
          int vertex = first[static_cast<std::size_t>(node)];
          for (std::size_t axis = 0; axis < edge / 8; ++axis) vertex += crossings.crosses(node, axis) ? 1 : 0;
          return vertex;
        };
        std::array<bool, kEdges> done{};
        for (std::size_t begin = 0; begin < kEdges; ++begin) {
          if (rings.next[begin] < 0 || done[begin]) continue;
          std::vector<int> ring;
          bool crowded = false;
          for (std::size_t edge = begin; !done[edge]; edge = static_cast<std::size_t>(rings.next[edge])) {
            done[edge] = true;
            crowded = crowded || rings.crowded[edge];
            ring.push_back(vertex_of(edge));
          }
          if (crowded && ring.size() > 3) {
            Crossings::Vertex middle{Vector3d::Zero(), Vector3d::Zero(), 0.0};
            for (const int i : ring) {
              const Crossings::Vertex& one = out.vertices[static_cast<std::size_t>(i)];
              middle.at += one.at / static_cast<double>(ring.size());
              middle.normal += one.normal;
              middle.deviation += one.deviation / static_cast<double>(ring.size());
            }
            middle.normal.normalize();
            const auto hub = static_cast<int>(out.vertices.size());
            out.vertices.push_back(middle);
            for (std::size_t i = 0; i < ring.size(); ++i)
              out.triangles.push_back({hub, ring[i], ring[(i + 1) % ring.size()]});
          } else {
            for (std::size_t i = 1; i + 1 < ring.size(); ++i) out.triangles.push_back({ring[0], ring[i], ring[i + 1]});
          }
        }
      }
    }
  }
  return out;
}

std::string mesh_ply(const ClosedMesh& mesh, double desk, const std::string& deviation, const std::string& comment) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float {}\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      comment, mesh.vertices.size(), deviation, mesh.triangles.size());
  const auto append = [&](const auto& value) {
    out.append(reinterpret_cast<const char*>(value.data()), sizeof(value[0]) * value.size());
  };
  out.reserve(out.size() + 28 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Crossings::Vertex& one : mesh.vertices) {
    Eigen::Matrix<float, 7, 1> numbers;
    numbers << one.at.cast<float>(), one.normal.cast<float>(), static_cast<float>(one.deviation);
    numbers(2) = static_cast<float>(one.at.z() + desk);
    append(numbers);
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    out += '\3';
    append(triangle);
  }
  return out;
}

}  // namespace palpate
