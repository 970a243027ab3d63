// SPDX-License-Identifier: MIT
// Heights over a grid as triangles: normals, orientation, and what hangs together.
#include "report/mesh_export.hpp"
#include "support/grids.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <set>
#include <utility>

namespace palpate {
namespace {

constexpr double kRounding = 1e-13;

/// A grid whose sides, numbers and distances all differ.
CandidateGrid oblong() {
  return test::product_grid(Eigen::VectorXd::LinSpaced(7, 0.01, 0.13), Eigen::Vector4d(0.1, 0.15, 0.2, 0.25));
}

template <class Height>
Eigen::VectorXd heights(const CandidateGrid& candidates, const Height& height) {
  Eigen::VectorXd out(candidates.size());
  for (int i = 0; i < candidates.size(); ++i) out(i) = height(candidates.points(i, 0), candidates.points(i, 1));
  return out;
}

/// Over oblong().
template <class Height>
Surface mesh_of(const Height& height) {
  const CandidateGrid candidates = oblong();
  return surface_mesh(candidates, heights(candidates, height), Eigen::VectorXd::Zero(candidates.size()));
}

Eigen::Vector3d corner(const Surface& mesh, int vertex) {
  return mesh.vertices[static_cast<std::size_t>(vertex)].position;
}

/// Twice the area of a triangle, along its normal by the order of its corners.
Eigen::Vector3d area_vector(const Surface& mesh, const std::array<int, 3>& t) {
  return (corner(mesh, t[1]) - corner(mesh, t[0])).cross(corner(mesh, t[2]) - corner(mesh, t[0]));
}

TEST(SurfaceMesh, OfAPlaneHasThePlanesNormalAtEveryVertexTheEdgesIncluded) {
  const double along_x = 0.7;
  const double along_y = -1.9;
  const Surface mesh = mesh_of([&](double x, double y) { return 0.03 + along_x * x + along_y * y; });
  const Eigen::Vector3d expected = Eigen::Vector3d(-along_x, -along_y, 1.0).normalized();
  ASSERT_EQ(mesh.vertices.size(), 28U);
  for (const Surface::Vertex& one : mesh.vertices)
    EXPECT_LT((one.normal - expected).cwiseAbs().maxCoeff(), kRounding) << one.position;
}

TEST(SurfaceMesh, OfALevelSurfaceLooksStraightUpWithoutAMinusBeforeAnyZero) {
  const Surface mesh = mesh_of([](double, double) { return 0.07; });
  ASSERT_EQ(mesh.vertices.size(), 28U);
  for (const Surface::Vertex& one : mesh.vertices) {
    EXPECT_EQ(one.normal, Eigen::Vector3d(0.0, 0.0, 1.0));
    EXPECT_FALSE(std::signbit(one.normal.x()) || std::signbit(one.normal.y()));
  }
}

TEST(SurfaceMesh, TakesCentralDifferencesInsideAndOneSidedOnesAtTheEdges) {
  // Of a parabola along x the central difference is the slope itself; at an edge it is that half a step inside.
  const double bend = 3.0;
  const CandidateGrid candidates = oblong();
  const Surface mesh = mesh_of([&](double x, double) { return bend * x * x; });
  const double step = candidates.xs(1) - candidates.xs(0);
  for (int row = 0; row < candidates.rows; ++row) {
    for (int column = 0; column < candidates.columns; ++column) {
      double x = candidates.xs(column);
      if (column == 0) x += step / 2;
      if (column == candidates.columns - 1) x -= step / 2;
      const Eigen::Vector3d expected = Eigen::Vector3d(-2 * bend * x, 0.0, 1.0).normalized();
      const std::size_t vertex = static_cast<std::size_t>(row) * static_cast<std::size_t>(candidates.columns) +
                                 static_cast<std::size_t>(column);
      EXPECT_LT((mesh.vertices[vertex].normal - expected).cwiseAbs().maxCoeff(), kRounding);
    }
  }
}

TEST(SurfaceMesh, CoversTheRectangleOfItsVerticesOnce) {
  const double tilt = 2.0;
  const Surface mesh = mesh_of([&](double x, double) { return tilt * x; });
  double seen_from_above = 0.0;
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) {
    seen_from_above += area_vector(mesh, triangle).z() / 2;
    area += area_vector(mesh, triangle).norm() / 2;
  }
  EXPECT_NEAR(seen_from_above, 0.12 * 0.15, kRounding);
  EXPECT_NEAR(area, 0.12 * 0.15 * std::hypot(1.0, tilt), kRounding);
}

TEST(SurfaceMesh, IsADiscWhoseInnerEdgesHaveATriangleOnEitherSide) {
  const Surface mesh = mesh_of([](double, double) { return 0.0; });
  std::set<std::pair<int, int>> directed;
  std::set<std::pair<int, int>> edges;
  std::set<int> vertices;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int from = t[static_cast<std::size_t>(i)];
      const int to = t[static_cast<std::size_t>((i + 1) % 3)];
      EXPECT_TRUE(directed.emplace(from, to).second) << "two triangles on one side of an edge";
      edges.emplace(std::min(from, to), std::max(from, to));
      vertices.insert(from);
    }
  }
  EXPECT_EQ(vertices.size(), 28U);
  EXPECT_EQ(
      static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size()), 1)
      << "Euler characteristic of a disc";
  EXPECT_EQ(2 * edges.size() - directed.size(), 2U * (6 + 3)) << "edges of the rim have one triangle";
}

TEST(SurfaceMesh, OfASingleRowOrASingleCandidateHasNoTriangleAndLevelNormalsAcross) {
  const CandidateGrid row = test::product_grid(Eigen::Vector3d(0.0, 0.1, 0.2), Eigen::VectorXd::Constant(1, 0.5));
  const Surface strip = surface_mesh(row, Eigen::Vector3d(0.0, 0.1, 0.2), Eigen::Vector3d::Zero());
  EXPECT_TRUE(strip.triangles.empty());
  ASSERT_EQ(strip.vertices.size(), 3U);
  for (const Surface::Vertex& one : strip.vertices)
    EXPECT_LT((one.normal - Eigen::Vector3d(-1, 0, 1).normalized()).norm(), kRounding);

  const CandidateGrid one = test::product_grid(Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Constant(1, 0.5));
  const Surface point = surface_mesh(one, Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Constant(1, 0.01));
  EXPECT_TRUE(point.triangles.empty());
  EXPECT_EQ(point.vertices.at(0).normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(point.vertices.at(0).standard_deviation, 0.01);
}

}  // namespace
}  // namespace palpate
