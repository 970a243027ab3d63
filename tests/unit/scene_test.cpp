// SPDX-License-Identifier: MIT
#include "gp/candidates.hpp"
#include "scene/scene_options.hpp"
#include "support/filled.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The area of the paper, with one object or none.
SceneOptions with(const std::string& object) {
  return test::filled<SceneOptions>("{area: {width: 23 cm, depth: 23 cm}, objects: [" + object + "]}");
}

TEST(Scene, ObjectIHasTheHeightsOfThePaper) {
  const auto scene = build_scene(with("{type: wave}"), 1, test::shared_host());
  EXPECT_DOUBLE_EQ(scene->height(0.115, 0.115), 0.11) << "a crest at the centre";
  EXPECT_DOUBLE_EQ(scene->height(0.155, 0.115), 0.07) << "a trough 4 cm along the length";
  EXPECT_DOUBLE_EQ(scene->height(0.135, 0.115), 0.09);
  EXPECT_DOUBLE_EQ(scene->height(0.115, 0.115 + 0.0299), 0.11);
  EXPECT_DOUBLE_EQ(scene->height(0.115, 0.115 + 0.0301), 0.0);
  EXPECT_DOUBLE_EQ(scene->height(0.115 + 0.0801, 0.115), 0.0);
  EXPECT_DOUBLE_EQ(scene->highest(), 0.11);
}

TEST(Scene, ObjectIiRisesFromTwoToEightCentimetres) {
  const auto scene = build_scene(with("{type: slope}"), 1, test::shared_host());
  EXPECT_NEAR(scene->height(0.115 - 0.0849999, 0.115), 0.02, 1e-7);
  EXPECT_NEAR(scene->height(0.115, 0.115), 0.05, 1e-15);
  EXPECT_NEAR(scene->height(0.115 + 0.0849999, 0.115), 0.08, 1e-7);
  EXPECT_NEAR(scene->highest(), 0.08, 1e-15);
}

TEST(Scene, RotationTurnsCounterClockwise) {
  const auto scene = build_scene(with("{type: wave, at: [10 cm, 10 cm], rotation: 30 deg}"), 1, test::shared_host());
  const double along = 0.04;  // a trough
  EXPECT_NEAR(scene->height(0.1 + along * std::cos(kPi / 6), 0.1 + along * std::sin(kPi / 6)), 0.07, 1e-12);
}

TEST(Scene, OnSurfaceIsStrictlyAboveTheMargin) {
  SceneOptions options;
  options.desk = 0.2;
  const auto scene = build_scene(options, 1, test::shared_host());
  EXPECT_FALSE(scene->on_surface(0.21));
  EXPECT_TRUE(scene->on_surface(0.2101));
  EXPECT_DOUBLE_EQ(scene->height(0.1, 0.1), 0.2);
}

TEST(Scene, RandomPlacementKeepsTheObjectWhollyInsideAndDependsOnTheSeed) {
  SceneOptions options = with("{type: wave}");
  options.placement = SceneOptions::Placement::random;
  double first = -1.0;
  bool moved = false;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto scene = build_scene(options, seed, test::shared_host());
    double cells = 0.0;
    constexpr int kFine = 460;
    for (int i = 0; i < kFine; ++i) {
      for (int j = 0; j < kFine; ++j) {
        cells += scene->on_surface(scene->height((i + 0.5) * 0.23 / kFine, (j + 0.5) * 0.23 / kFine)) ? 1 : 0;
      }
    }
    // 16 x 6 cm: if any of it lay outside, the area seen within would be smaller.
    EXPECT_NEAR(cells * 0.0005 * 0.0005, 0.0096, 0.0002) << "seed " << seed;
    const double here = scene->height(0.115, 0.115);
    if (first < 0.0) first = here;
    moved = moved || here != first;
    EXPECT_EQ(here, build_scene(options, seed, test::shared_host())->height(0.115, 0.115));
  }
  EXPECT_TRUE(moved);
}

TEST(Scene, AnObjectTooLargeForTheAreaIsRefused) {
  SceneOptions options = with("{type: wave, length: 40 cm}");
  options.placement = SceneOptions::Placement::random;
  EXPECT_THROW(build_scene(options, 1, test::shared_host()), Error);
}

TEST(Candidates, AreCellCentresRowByRow) {
  const Candidates candidates = grid_by_count({0.4, 0.2}, 2);
  ASSERT_EQ(candidates.size(), 4);
  EXPECT_DOUBLE_EQ(candidates.points(0, 0), 0.1);
  EXPECT_DOUBLE_EQ(candidates.points(0, 1), 0.05);
  EXPECT_DOUBLE_EQ(candidates.points(1, 0), 0.3);
  EXPECT_DOUBLE_EQ(candidates.points(2, 1), 0.15);
}

TEST(Candidates, FiveMillimetresGive46PerSideOf23Centimetres) {
  const Candidates candidates = grid_by_spacing({0.23, 0.23}, 0.005);
  EXPECT_EQ(candidates.columns, 46);
  EXPECT_EQ(candidates.rows, 46);
}

TEST(Candidates, EveryOneIsNearestToItself) {
  const Area area{0.23, 0.17};
  for (const int count : {1, 2, 46, 47, 231}) {
    const Candidates candidates = grid_by_count(area, count);
    for (int i = 0; i < candidates.size(); ++i) {
      const Target at = candidates.target(i);
      ASSERT_EQ(candidates.nearest(at.x, at.y, area), i);
    }
  }
  EXPECT_EQ(grid_by_count(area, 3).nearest(-1.0, 9.0, area), 6) << "outside, the nearest cell";
}

}  // namespace
}  // namespace palpate
