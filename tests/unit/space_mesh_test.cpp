// SPDX-License-Identifier: MIT
// The mesh of what is believed in space: closed whatever it is made from, on the surface, and as large as solids are.
#include "record/mesh_ply.hpp"
#include "solids/mesh.hpp"
#include "support/plugins.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/Geometry>

#include <cstring>
#include <map>
#include <utility>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Mesh = palpate::Surface;

/// An assembly and the residual GP over it, after touches that were off by a millimetre or two.
struct Believed {
  explicit Believed(const std::vector<Primitive>& primitives, std::vector<SurfaceTouch> made = {})
      : residual_gp(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005}),
        touches(std::move(made)) {
    for (const Primitive& primitive : primitives) solids.parts.push_back({primitive, {}, {}, 0.0});
    residual_gp.fit(solids, touches);
  }
  Crossings crossings(double side) const { return cross_surface(solids, residual_gp, side); }
  Mesh mesh(double side, double desk = 0.0) const { return close_mesh(crossings(side), desk); }

  Assembly solids;
  ResidualGp residual_gp;
  std::vector<SurfaceTouch> touches;
};

Matrix3d turned(Random& random) {
  return Eigen::AngleAxisd(3.0 * random.uniform(), random_direction(random)).toRotationMatrix();
}

Believed any_belief(Random& random) {
  std::vector<Primitive> primitives;
  for (std::size_t i = 0; i <= random.index(4); ++i) {
    Primitive primitive;
    primitive.form = static_cast<Primitive::Form>(random.index(3));
    primitive.centre = Vector3d(0.1, 0.1, 0.06) + 0.04 * random_direction(random);
    primitive.turn = turned(random);
    for (Eigen::Index k = 0; k < 3; ++k) primitive.half(k) = 0.006 + 0.04 * random.uniform();
    if (random.uniform() < 0.5)
      primitive.wall = std::min(0.002 + 0.004 * random.uniform(), 0.5 * primitive.half.minCoeff());
    primitives.push_back(primitive);
  }
  const Believed bare(primitives);
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 15; ++i) {
    const Vector3d direction = random_direction(random);
    const Line line{Vector3d(0.1, 0.1, 0.06) - 0.3 * direction, direction};
    const double hit = bare.solids.first_intersection(line);
    if (hit == kNoHit) continue;
    touches.push_back({line, hit + 0.004 * (random.uniform() - 0.5), true, false});
    // And a way past it, a little inside.
    const Vector3d at = line.origin + hit * direction;
    const Vector3d out = bare.solids.normal(at);
    const Vector3d along = out.unitOrthogonal();
    if (i % 3 == 0) touches.push_back({{at - 0.003 * random.uniform() * out - 0.3 * along, along}, 0.6, false, false});
  }
  return Believed(primitives, touches);
}

/// How many edges there are; a failure where one is not shared by two triangles that go along it in either direction.
int edges_of(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> directed;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++directed[{triangle[i], triangle[(i + 1) % 3]}];
  }
  int unpaired = 0;
  for (const auto& [edge, count] : directed)
    unpaired += count == 1 && directed.count({edge.second, edge.first}) == 1 ? 0 : 1;
  EXPECT_EQ(unpaired, 0);
  return static_cast<int>(directed.size()) / 2;
}

/// 2 for each surface without a hole through it.
int euler(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - edges_of(mesh) + static_cast<int>(mesh.triangles.size());
}

double volume(const Mesh& mesh) {
  double out = 0.0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(triangle[i])].position; };
    out += at(0).dot(at(1).cross(at(2))) / 6.0;
  }
  return out;
}

TEST(ClosedMesh, HasTwoTrianglesInOppositeDirectionsAtEachEdgeWhateverIsBelieved) {
  Random random(1, "test/mesh");
  std::size_t triangles = 0;
  for (int i = 0; i < 60; ++i) {
    const Believed belief = any_belief(random);
    const Mesh mesh = belief.mesh(i % 2 == 0 ? 0.003 : 0.006);
    triangles += mesh.triangles.size();
    edges_of(mesh);
    EXPECT_GT(volume(mesh), 0.0);
  }
  EXPECT_GT(triangles, 100000U);
}

TEST(ClosedMesh, DoesNotLie) {
  Random random(2, "test/mesh");
  int off = 0;
  int all = 0;
  std::size_t free = 0;
  for (int i = 0; i < 20; ++i) {
    const Believed belief = any_belief(random);
    free += belief.residual_gp.free_paths().points.size();
    for (const Mesh::Vertex& one : belief.crossings(0.003).vertices) {
      const Vector3d normal = belief.solids.normal(one.position);
      const double value = std::max(
          belief.solids.distance(one.position) - belief.residual_gp.mean({one.position, normal}), -one.position.z());
      // Vertices stay a hundredth of a cube, 3e-5, away from its corners, and f rises by little more than 1.
      off += std::abs(value) > 4e-5 ? 1 : 0;
      ++all;
      // The residual GP jumps where normals do, and there is a surface between: from no less than -reach() to no more
      // than it.
      EXPECT_LT(std::abs(value), 2.0 * belief.residual_gp.reach() + 4e-5);
      EXPECT_NEAR(one.normal.norm(), 1.0, 1e-9);
    }
  }
  EXPECT_GT(free, 10U);
  // Normals jump along the edges of primitives and where two of them meet, lines on a surface that has a thousand
  // vertices.
  EXPECT_LT(off, all / 50);
}

TEST(ClosedMesh, IsWhereAWayHasPushedTheSurface) {
  const Primitive plate{Primitive::Form::box, {0.1, 0.05, 0.1}, Matrix3d::Identity(), {0.1, 0.05, 0.1}, 0.0};
  const auto onto = [](double x, double off) {
    return SurfaceTouch{{{x, 0.3, 0.1}, {0, -1, 0}}, 0.2 - off, true, false};
  };
  const Believed belief({plate},
                        {onto(0.02, 0.002), onto(0.18, -0.002), {{{0.1, 0.095, 0.4}, {0, 0, -1}}, 0.39, false, false}});
  double least = 1.0;
  for (const Mesh::Vertex& one : belief.crossings(0.0025).vertices) {
    if (std::abs(one.position.x() - 0.1) > 0.01 || std::abs(one.position.z() - 0.1) > 0.03 || one.position.y() < 0.05)
      continue;
    const double value =
        belief.solids.distance(one.position) - belief.residual_gp.mean({one.position, Vector3d::UnitY()});
    EXPECT_NEAR(value, 0.0, 4e-5);  // as in DoesNotLie
    least = std::min(least, one.position.y());
  }
  EXPECT_LT(least, 0.0965);
}

TEST(ClosedMesh, HasTheNormalsOfItsTriangles) {
  // The residual GP rises from one contact to the other, by a tenth.
  const Primitive plate{Primitive::Form::box, {0.1, 0.05, 0.1}, Matrix3d::Identity(), {0.1, 0.05, 0.1}, 0.0};
  const auto onto = [](double x, double off) {
    return SurfaceTouch{{{x, 0.3, 0.1}, {0, -1, 0}}, 0.2 - off, true, false};
  };
  const Believed belief({plate}, {onto(0.08, -0.004), onto(0.12, 0.004)});
  const Mesh mesh = belief.mesh(kFineResolution);
  int seen = 0;
  double turned = 0.0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto of = [&](std::size_t i) -> const Mesh::Vertex& {
      return mesh.vertices[static_cast<std::size_t>(triangle[i])];
    };
    const Vector3d across = (of(1).position - of(0).position).cross(of(2).position - of(0).position);
    if (of(0).position.y() < 0.09 || (of(0).position - Vector3d(0.1, of(0).position.y(), 0.1)).norm() > 0.01) continue;
    if (across.norm() < 1e-7) continue;  // a sliver has no direction
    ++seen;
    // Over a cube of 2 mm a surface that bends by a tenth over 2 cm turns by a hundredth.
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((across.normalized() - of(i).normal).norm(), 0.02);
    turned = std::max(turned, (across.normalized() - Vector3d::UnitY()).norm());
  }
  EXPECT_GT(seen, 50);
  EXPECT_GT(turned, 0.1);  // the assembly's normals would not do
}

TEST(ClosedMesh, EnclosesWhatTheSolidsDo) {
  Random random(3, "test/mesh");
  for (const Primitive::Form form : {Primitive::Form::box, Primitive::Form::cylinder, Primitive::Form::ellipsoid}) {
    for (int i = 0; i < 4; ++i) {
      Primitive primitive{form, {0.1, 0.1, 0.1}, turned(random), {0.05, 0.03, 0.04}, 0.0};
      const Mesh whole = Believed({primitive}).mesh(kFineResolution);
      // Edges are cut by less than half a cube of 2 mm, and so is what bends, by its square over the radius: together
      // below one in a hundred of something 6 to 10 cm wide.
      EXPECT_NEAR(volume(whole) / primitive.volume(), 1.0, 0.01);
      EXPECT_EQ(euler(whole), 2);
      primitive.wall = 0.004;
      const double outer = form == Primitive::Form::ellipsoid ? primitive.volume() : volume(whole);
      const Vector3d inner = primitive.half.array() - primitive.wall;
      Primitive hollow = primitive;
      hollow.half = inner;
      const double within = form == Primitive::Form::ellipsoid ? hollow.volume()
                            : form == Primitive::Form::box
                                ? 8.0 * inner.x() * inner.y() * (inner.z() + 0.5 * primitive.wall)
                                : 2.0 * kHalfTurn * inner.x() * inner.y() * (inner.z() + 0.5 * primitive.wall);
      const Mesh vessel = Believed({primitive}).mesh(kFineResolution);
      // Of a wall of 4 mm, rims included, the same is five in a hundred.
      EXPECT_NEAR(volume(vessel) / (outer - within), 1.0, 0.05);
    }
  }
}

TEST(ClosedMesh, HasNoHoleInAWallOfThreeMillimetresNorOnAPage) {
  constexpr double kPageSide = 0.0025;  // see report/history.cpp
  for (const double side : {kFineResolution, kPageSide}) {
    Random random(4, "test/mesh");
    for (int i = 0; i < 12; ++i) {
      Primitive primitive{
          static_cast<Primitive::Form>(i % 3), {0.1, 0.1, 0.1}, turned(random), {0.04, 0.04, 0.05}, 0.003};
      EXPECT_EQ(euler(Believed({primitive}).mesh(side)), 2) << i << ", " << side;
    }
  }
}

TEST(ClosedMesh, SaysHowLargeItsCubesAreWhereTheyHadToGrow) {
  const Primitive small{Primitive::Form::box, {0.1, 0.1, 0.1}, Matrix3d::Identity(), {0.02, 0.03, 0.04}, 0.0};
  const Mesh fine = Believed({small}).mesh(kFineResolution);
  EXPECT_THAT(mesh_ply(fine, "quality", "a box"), testing::HasSubstr("comment a box, of cubes of 2 mm\n"));
  const Primitive large{Primitive::Form::box, {0.2, 0.2, 0.18}, Matrix3d::Identity(), {0.17, 0.17, 0.17}, 0.0};
  const Mesh coarse = Believed({large}).mesh(kFineResolution);
  // 34 x 34 x 35 cm are more than four million of 2 mm, and of 2.2 mm.
  EXPECT_DOUBLE_EQ(coarse.resolution, 1.1 * 1.1 * kFineResolution);
  EXPECT_THAT(mesh_ply(coarse, "quality", "a box"), testing::HasSubstr("comment a box, of cubes of 2.42 mm\n"));
}

TEST(ClosedMesh, EndsAtTheDesk) {
  const Primitive sunk{Primitive::Form::box, {0.1, 0.1, 0.02}, Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  const Mesh mesh = Believed({sunk}).mesh(kFineResolution);
  EXPECT_NEAR(volume(mesh), 0.1 * 0.06 * 0.05, 0.01 * 0.1 * 0.06 * 0.05);
  EXPECT_EQ(euler(mesh), 2);
  int below = 0;
  for (const Mesh::Vertex& one : mesh.vertices) {
    EXPECT_GT(one.position.z(), -1e-6);
    if (one.position.z() > 1e-6) continue;
    EXPECT_EQ(one.normal, Vector3d(-Vector3d::UnitZ()));
    ++below;
  }
  EXPECT_GT(below, 1000);
}

TEST(ClosedMesh, FollowsTheResidualGp) {
  const Primitive plate{Primitive::Form::box, {0.1, 0.1, 0.1}, Matrix3d::Identity(), {0.05, 0.003, 0.05}, 0.0};
  // 2 mm in front of one side.
  const Believed belief({plate}, {{{{0.1, 0.3, 0.1}, {0, -1, 0}}, 0.195, true, false}});
  double front = 0.0;
  double back = 1.0;
  for (const Mesh::Vertex& one : belief.crossings(kFineResolution).vertices) {
    if ((one.position - Vector3d(0.1, one.position.y(), 0.1)).norm() > 0.003) continue;
    front = std::max(front, one.position.y());
    back = std::min(back, one.position.y());
  }
  EXPECT_NEAR(front, 0.105, 2e-4);
  EXPECT_NEAR(back, 0.097, 4e-5);  // as far as vertices stay from nodes
}

TEST(ClosedMesh, IsNothingWhereNothingIsBelievedIn) {
  const Mesh mesh = Believed({}).mesh(kFineResolution);
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(ClosedMesh, IsAFileOfItsNumbers) {
  const Primitive box{Primitive::Form::box, {0.1, 0.1, 0.1}, Matrix3d::Identity(), {0.02, 0.03, 0.04}, 0.0};
  Mesh mesh = Believed({box}).mesh(0.01, 0.5);
  EXPECT_EQ(mesh.vertices.front().position,
            Believed({box}).mesh(0.01).vertices.front().position + Vector3d(0.0, 0.0, 0.5));
  mesh.vertices.front().standard_deviation = 0.003;
  const std::string file = mesh_ply(mesh, "quality", "a box");
  EXPECT_THAT(file, testing::HasSubstr("\ncomment a box, of cubes of 10 mm\nelement vertex " +
                                       std::to_string(mesh.vertices.size())));
  const std::size_t body = file.find("end_header\n") + 11;
  ASSERT_EQ(file.size(), body + 28 * mesh.vertices.size() + 13 * mesh.triangles.size());
  std::array<float, 7> first{};
  std::memcpy(first.data(), file.data() + body, sizeof first);
  const Mesh::Vertex& one = mesh.vertices.front();
  EXPECT_EQ(first[0], static_cast<float>(one.position.x()));
  EXPECT_EQ(first[2], static_cast<float>(one.position.z()));
  EXPECT_EQ(first[5], static_cast<float>(one.normal.z()));
  EXPECT_EQ(first[6], static_cast<float>(one.standard_deviation));
  std::array<std::int32_t, 3> last{};
  std::memcpy(last.data(), file.data() + file.size() - sizeof last, sizeof last);
  EXPECT_EQ(last[2], mesh.triangles.back()[2]);
}

}  // namespace
}  // namespace palpate::test
