// SPDX-License-Identifier: MIT
// Meshes made from the primitives agree with the primitives.
#include "support/sanitizers.hpp"
#include "support/shape_cases.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

namespace palpate::test {
namespace {

const char* const kPoses[] = {"", "rotation: 37 deg", "tilt: 25 deg", "tilt: -40 deg, rotation: 110 deg"};
const char* const kFormats[] = {"a.stl", "b.stl", "c.obj", "d.ply"};

std::string written(const Surface& surface, std::size_t format) {
  if (format == 0) return stl_binary(surface);
  if (format == 1) return stl_text(surface);
  return format == 2 ? obj(surface) : ply(surface);
}

/// Where heights 0.2 mm away differ by more than 0.8 mm, a wall or a steep slope is near, on which the distance between
/// surface and triangles, at most 3e-6 m, is not that of the heights.
bool wall_is_near(const Scene& scene, double x, double y) {
  constexpr double kMargin = 2e-4;
  const double here = scene.height(x, y);
  for (const double dx : {-kMargin, 0.0, kMargin}) {
    for (const double dy : {-kMargin, 0.0, kMargin}) {
      if (std::abs(scene.height(x + dx, y + dy) - here) > 4 * kMargin) return true;
    }
  }
  return false;
}

class MeshOfPrimitive : public testing::TestWithParam<ShapeCase> {};

TEST_P(MeshOfPrimitive, HasItsHeights) {
  const int places = brief() ? 1000 : 4000;
  const TemporaryFolder folder;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto file = folder.write(kFormats[i], written(GetParam().surface(), i));
    const std::string pose = std::string("at: [20 cm, 20 cm]") + (i > 0 ? ", " : "") + kPoses[i];
    const auto exact = scene_of({with_fields(GetParam().options, pose)});
    const auto mesh = scene_of({with_fields("{type: mesh, file: '" + file.string() + "', unit: 1 mm}", pose)});
    EXPECT_NEAR(mesh->highest(), exact->highest(), 5e-6);
    Random random(1, "test/mesh");
    int on_object = 0;
    double worst = 0.0;
    for (int k = 0; k < places; ++k) {
      const double x = 0.13 + 0.14 * random.uniform();
      const double y = 0.13 + 0.14 * random.uniform();
      if (wall_is_near(*exact, x, y)) continue;
      worst = std::max(worst, std::abs(mesh->height(x, y) - exact->height(x, y)));
      on_object += exact->height(x, y) > 0.0 ? 1 : 0;
    }
    EXPECT_LT(worst, 1e-5) << kFormats[i] << " " << pose;
    EXPECT_GT(on_object, places * 3 / 40) << pose;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, MeshOfPrimitive, testing::ValuesIn(shape_cases()),
                         [](const auto& one) { return one.param.name; });

std::string mesh_at(const std::filesystem::path& file, const std::string& more = "") {
  return "{type: mesh, file: '" + file.string() + "', unit: 1 mm, at: [20 cm, 20 cm]" + more + "}";
}

using MeshInAFile = InFolder;

TEST_F(MeshInAFile, StandsOnTheDeskAtTheCentreOfItsRectangleWhereverItsFileHasItsOrigin) {
  Surface block = extruded([](double) { return 0.03; }, 0.08, 0.05, 1);
  for (Eigen::Vector3d& point : block.points) point += Eigen::Vector3d(0.7, -0.3, -0.2);
  const auto scene = scene_of({mesh_at(folder_.write("a.ply", ply(block)))});
  EXPECT_NEAR(scene->height(0.2 - 0.0399, 0.2 + 0.0249), 0.03, 1e-7);
  EXPECT_NEAR(scene->height(0.2 + 0.0399, 0.2 - 0.0249), 0.03, 1e-7);
  EXPECT_EQ(scene->height(0.2 + 0.0401, 0.2), 0.0);
  EXPECT_NEAR(scene->highest(), 0.03, 1e-7);
}

TEST_F(MeshInAFile, TurnsAFileWhoseYIsUp) {
  Surface block = extruded([](double) { return 0.03; }, 0.08, 0.05, 1);
  for (Eigen::Vector3d& point : block.points) point = {point.x(), point.z(), -point.y()};
  const auto scene = scene_of({mesh_at(folder_.write("a.obj", obj(block)), ", up: y")});
  EXPECT_NEAR(scene->height(0.2 + 0.0399, 0.2 + 0.0249), 0.03, 1e-7);
  EXPECT_EQ(scene->height(0.2, 0.2 + 0.0251), 0.0);
}

TEST_F(MeshInAFile, LetsNoLineSlipBetweenItsTriangles) {
  // Two triangles and four make the top: lines along their edges and through their corners.
  const Surface cap = raised(
      {-0.05, 0.0, 0.05}, {-0.05, 0.0, 0.05}, [](double, double) { return true; }, 0.02);
  const auto scene = scene_of({mesh_at(folder_.write("a.stl", stl_binary(cap)))});
  for (int i = -4900; i <= 4900; ++i) {
    const double d = i * 1e-5;
    EXPECT_NEAR(scene->height(0.2 + d, 0.2 + d), 0.02, 1e-7);
    EXPECT_NEAR(scene->height(0.2 + d, 0.2), 0.02, 1e-7);
    EXPECT_NEAR(scene->height(0.2, 0.2 + d), 0.02, 1e-7);
  }
}

TEST_F(MeshInAFile, IsPlacedAtRandomWhollyInside) {
  const auto file = folder_.write("a.stl", stl_binary(shape_cases().front().surface()));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    // The primitive and its mesh draw the same numbers and have the same reach, but for the rounding of the file.
    const auto mesh = scene_of({mesh_at(file)}, seed, ", placement: random");
    const auto exact = scene_of({shape_cases().front().options}, seed, ", placement: random");
    for (int i = 0; i < 40; ++i) {
      const double at = 0.01 * i;
      if (wall_is_near(*exact, at, 0.4 - at)) continue;
      EXPECT_NEAR(mesh->height(at, 0.4 - at), exact->height(at, 0.4 - at), 1e-5);
    }
  }
}

}  // namespace
}  // namespace palpate::test
