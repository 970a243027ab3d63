// SPDX-License-Identifier: MIT
// What is solid, by cubes: of a scene, of primitives, and with what the residual GP adds.
#include "solids/volume.hpp"

#include "space_bench.hpp"
#include "support/testing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

TEST(Cubes, HoldWhatIsSolidAndNotWhatItEncloses) {
  const auto scene = scene_of_cup();
  const Cubes cubes(kMiddleOfCup, 0.18, 0.004);
  const Cubes::Held truth = cubes.of(*scene);
  const auto volume = [](const Cubes::Held& held) {
    return 0.004 * 0.004 * 0.004 * static_cast<double>(std::count(held.begin(), held.end(), true));
  };
  EXPECT_NEAR(volume(truth), kHalfTurn * (0.04 * 0.04 - 0.03 * 0.03) * 0.06, 9e-6)
      << "of 132 cubic centimetres, to what cubes of 4 mm make of it";
  EXPECT_EQ(intersection_over_union(truth, truth), 1.0);
  EXPECT_EQ(intersection_over_union(truth, Cubes::Held(truth.size())), 0.0);
  EXPECT_EQ(intersection_over_union(Cubes::Held(truth.size()), Cubes::Held(truth.size())), 1.0);
}

TEST(Cubes, OfAnAssemblyAreThoseWhoseCentresThePrimitivesHold) {
  Random random(9, "test/cubes");
  const ResidualGp nothing(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005});
  const Cubes cubes({0.0, 0.0, 0.1}, 0.12, 0.006);
  for (int i = 0; i < 10; ++i) {
    Assembly one;
    for (int k = 0; k < 2; ++k) {
      Primitive primitive = random_primitive(random);
      primitive.centre.z() += 0.1;
      one.parts.push_back({primitive, {}, {}, 0.0});
    }
    const Cubes::Held held = cubes.of(one, nothing);
    std::size_t index = 0;
    int count = 0;
    for (int x = 0; x < 40; ++x) {
      for (int y = 0; y < 40; ++y) {
        for (int z = 0; z < 37; ++z, ++index) {
          const Vector3d at(-0.117 + 0.006 * x, -0.117 + 0.006 * y, 0.003 + 0.006 * z);
          const bool within = holds(one.parts[0].primitive, at) || holds(one.parts[1].primitive, at);
          count += held[index] == within ? 0 : 1;
        }
      }
    }
    ASSERT_EQ(index, held.size());
    EXPECT_EQ(count, 0);
  }
}

TEST(Cubes, AreFewerOrMoreByWhatTheResidualGpAdds) {
  Assembly ball;
  ball.parts.push_back(
      {{Primitive::Form::ellipsoid, {0, 0, 0.1}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.05}, 0.0}, {}, {}, 0.0});
  ResidualGp residual_gp(make<Kernel>(shared_host(), "matern32", "{length_scale: 8 cm}"), {0.006, 0.0005});
  std::vector<SurfaceTouch> touches;  // 4 mm outside all around
  Random random(10, "test/cubes");
  for (int i = 0; i < 150; ++i) {
    const Vector3d out = random_direction(random);
    touches.push_back({{Vector3d(0, 0, 0.1) + 0.154 * out, -out}, 0.1, true, false});
  }
  residual_gp.fit(ball, touches);
  const Cubes::Held held = Cubes({0, 0, 0.1}, 0.12, 0.003).of(ball, residual_gp);
  const double volume = 2.7e-8 * static_cast<double>(std::count(held.begin(), held.end(), true));
  EXPECT_NEAR(std::cbrt(volume * 3 / (4 * kHalfTurn)), 0.054, 5e-4);
}

TEST(Cubes, OfPrimitivesSideBySideHaveWhatTheResidualGpAddsToEach) {
  // Two plates that face y, from -4.5 to 0.5 mm and from 7 to 9 mm. The first is 2.5 mm farther out in front.
  Assembly plates;
  for (const auto& [middle, half] : {std::pair(-0.002, 0.0025), {0.008, 0.001}}) {
    const Primitive plate{
        Primitive::Form::box, {0, middle, 0.06}, Eigen::Matrix3d::Identity(), {0.048, half, 0.048}, 0.0};
    plates.parts.push_back({plate, {}, {}, 0.0});
  }
  std::vector<SurfaceTouch> touches;
  for (int x = -4; x <= 4; ++x) {
    for (int z = 2; z <= 10; ++z) {
      touches.push_back({{{0.01 * x, 0.0065, 0.01 * z}, {0, -1, 0}}, 0.0035, true, false});
      touches.push_back({{{0.01 * x, 0.2, 0.01 * z}, {0, -1, 0}}, 0.191, true, false});
    }
  }
  ResidualGp residual_gp(make<Kernel>(shared_host(), "matern32", "{length_scale: 1 cm}"), {0.006, 0.0001});
  residual_gp.fit(plates, touches);
  const Cubes::Held held = Cubes({0, 0, 0.06}, 0.08, 0.004).of(plates, residual_gp);
  // Centres at y = -2 and 2 mm, 24 across and 24 up, but for some at the corners, far from contacts. Those at 10 mm,
  // half as many, would be solid with what is added to the other.
  EXPECT_NEAR(static_cast<double>(std::count(held.begin(), held.end(), true)), 2 * 24 * 24, 24);
}

TEST(Scene, TellsWhichPartsOfALineLieInItsObjectsAlsoWhereTheyOverlap) {
  const auto scene = scene_of_cup();
  const std::vector<LineInterval> across = scene->intervals({{0.0, 0.13, 0.05}, {1.0, 0.0, 0.0}});
  ASSERT_EQ(across.size(), 2U);
  EXPECT_NEAR(across[0].begin, 0.09, 1e-12);
  EXPECT_NEAR(across[0].end, 0.10, 1e-12);
  EXPECT_NEAR(across[1].begin, 0.16, 1e-12);
  EXPECT_NEAR(across[1].end, 0.17, 1e-12);
  EXPECT_TRUE(scene->intervals({{0.0, 0.13, 0.09}, {1.0, 0.0, 0.0}}).empty());
  const std::vector<LineInterval> all = joined({{0.3, 0.4}, {0.0, 0.1}, {0.05, 0.2}, {0.1, 0.12}});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].end, 0.2);
  EXPECT_EQ(all[1].begin, 0.3);
}

}  // namespace
}  // namespace palpate::test
