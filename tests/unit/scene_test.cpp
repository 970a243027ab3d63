// SPDX-License-Identifier: MIT
#include "scene/scene_options.hpp"
#include "support/grids.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

TEST(Scene, OnSurfaceIsStrictlyAboveTheMargin) {
  SceneOptions options;
  options.desk = 0.2;
  const auto scene = build_scene(options, 1, test::shared_host());
  EXPECT_FALSE(scene->on_object(0.21));
  EXPECT_TRUE(scene->on_object(0.2101));
  EXPECT_DOUBLE_EQ(scene->height(0.1, 0.1), 0.2);
}

TEST(CandidateGrid, AreCellCentresRowByRow) {
  const CandidateGrid candidates = grid_by_count({0.4, 0.2}, 2);
  ASSERT_EQ(candidates.size(), 4);
  EXPECT_DOUBLE_EQ(candidates.points(0, 0), 0.1);
  EXPECT_DOUBLE_EQ(candidates.points(0, 1), 0.05);
  EXPECT_DOUBLE_EQ(candidates.points(1, 0), 0.3);
  EXPECT_DOUBLE_EQ(candidates.points(2, 1), 0.15);
}

TEST(CandidateGrid, FiveMillimetresGive46PerSideOf23Centimetres) {
  const CandidateGrid candidates = grid_by_spacing({0.23, 0.23}, 0.005);
  EXPECT_EQ(candidates.columns, 46);
  EXPECT_EQ(candidates.rows, 46);
}

TEST(CandidateGrid, EveryOneIsNearestToItself) {
  const Area area{0.23, 0.17};
  for (const int count : {1, 2, 46, 47, 231}) {
    const CandidateGrid candidates = grid_by_count(area, count);
    for (int i = 0; i < candidates.size(); ++i) {
      const Target at = candidates.target(i);
      ASSERT_EQ(candidates.nearest(at.x, at.y, area), i);
    }
  }
  EXPECT_EQ(grid_by_count(area, 3).nearest(-1.0, 9.0, area), 6) << "outside, the nearest cell";
}

}  // namespace
}  // namespace palpate::test
