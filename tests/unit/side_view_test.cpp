// SPDX-License-Identifier: MIT
// A look from one side, at a cup.
#include "solids/camera_rays.hpp"

#include "experiment/experiment.hpp"
#include "solids/cloud_distances.hpp"
#include "space_bench.hpp"
#include "support/testing.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

TEST(SideView, IsFreeUpToWhereTheSceneIsFirstMetAndKnowsObjectFromDesk) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  options.azimuth = 0.5;
  const std::vector<SurfaceTouch> view = side_view(options, *scene, kMiddleOfCup, 0.12, Random(1, "view"));
  ASSERT_EQ(view.size(), 400U);
  EXPECT_TRUE(shows_object(view));
  int on = 0, desk = 0, nothing = 0;
  for (const SurfaceTouch& ray : view) {
    EXPECT_NEAR((ray.line.origin - kMiddleOfCup).norm(), 0.6, 1e-12);
    EXPECT_NEAR((ray.line.origin - kMiddleOfCup).z(), 0.6 * std::sin(options.elevation), 1e-12);
    const double hit = scene->first_intersection({ray.line.origin + Vector3d(0, 0, 0.02), ray.line.direction});
    if (ray.contact && !ray.desk) {
      ++on;
      EXPECT_EQ(ray.length, hit);
    } else {
      EXPECT_LT(ray.length, hit);
      ++(ray.desk ? desk : nothing);
      EXPECT_NEAR(ray.desk ? ray.end().z() : 0.0, 0.0, 1e-12);
    }
  }
  EXPECT_GT(on, 20);
  EXPECT_GT(desk, 100);
  // From level some rays meet nothing.
  options.elevation = 0.0;
  for (const SurfaceTouch& ray : side_view(options, *scene, kMiddleOfCup, 0.12, Random(1, "view")))
    nothing += ray.contact ? 0 : 1;
  EXPECT_GT(nothing, 50);
}

TEST(SideView, IsFromWhereTheSeedSaysUnlessTheConfigDoes) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  const auto eye = [&](std::uint64_t seed) {
    return side_view(options, *scene, kMiddleOfCup, 0.12, Random(seed, "view")).front().line.origin;
  };
  EXPECT_EQ(eye(1), eye(1));
  EXPECT_GT((eye(1) - eye(2)).norm(), 1e-3);
  options.azimuth = 1.0;
  EXPECT_EQ(eye(1), eye(2));
  options.elevation = kHalfTurn / 2;  // from above, too
  EXPECT_NEAR((eye(1) - kMiddleOfCup - Vector3d(0, 0, 0.6)).norm(), 0.0, 1e-12);
}

TEST(SideView, IsThinnedToRaysOfEachKindOfWhichThoseOnTheObjectLieApart) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  options.azimuth = 0.5;
  options.rays = 3600;
  const std::vector<SurfaceTouch> view = side_view(options, *scene, kMiddleOfCup, 0.12, Random(1, "view"));
  const std::vector<SurfaceTouch> few = thinned_view(view, 160);
  EXPECT_LE(few.size(), 160U);
  EXPECT_GT(few.size(), 120U);
  Cloud ends;
  int others = 0;
  for (const SurfaceTouch& ray : few) {
    EXPECT_TRUE(std::any_of(view.begin(), view.end(), [&](const SurfaceTouch& one) {
      return one.line.direction == ray.line.direction && one.length == ray.length && one.desk == ray.desk;
    }));
    if (ray.contact && !ray.desk) ends.push_back(ray.end());
    others += ray.desk || !ray.contact ? 1 : 0;
  }
  EXPECT_GT(ends.size(), 60U);
  EXPECT_LE(ends.size(), 96U);
  EXPECT_GT(others, 40);
  EXPECT_GT(thinned(ends, 0.006).size(), ends.size() * 9 / 10) << "the cubes may be a little larger";
  // Where all that is seen is desk, some of that is kept.
  std::vector<SurfaceTouch> desk = view;
  for (SurfaceTouch& ray : desk) ray.desk = true;
  EXPECT_EQ(thinned_view(desk, 160).size(), 160U);
}

TEST(SideView, IsRefusedWhereAnotherWorldIsTappedThanTheScene) {
  class Elsewhere final : public Backend {
   public:
    TapResult tap(const TapRequest&) override { return {}; }
    bool repeatable() const override { return true; }
    bool taps_any_line() const override { return true; }
    bool scene_is_truth() const override { return false; }
  };
  std::vector<std::string> words = cup();
  words.emplace_back("belief.view={}");
  const ResolvedConfig config = shipped_config("any_side.yaml", words);
  const auto begin = [&] { Experiment(config.options, {shared_host(), nullptr, std::make_shared<Elsewhere>()}); };
  EXPECT_THAT(error_of(begin), testing::HasSubstr("belief.view: uses the scene of the config"));
}

}  // namespace
}  // namespace palpate::test
