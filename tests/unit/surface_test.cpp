// SPDX-License-Identifier: MIT
// `surface: two_part`: heights from the taps on an object alone, gated by the weight.
#include "experiment/metrics.hpp"
#include "record/summary.hpp"
#include "support/arrays.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

namespace palpate::test {
namespace {

/// A belief of its own, without a loop around it.
struct Alone {
  explicit Alone(const std::vector<std::string>& overrides)
      : config(shipped_config("paper/object_i.yaml", overrides)),
        scene(build_scene(config.options.scene, 1, test::shared_host())),
        context{test::shared_host(), *scene, 1, nullptr},
        candidates(grid_by_count(scene->area(), 9)),
        belief(config.options, candidates, context, clock) {
    belief.ask(Quantity::height | Quantity::probability);
  }

  void touch(int candidate, double height) {
    belief.observe(candidates.target(candidate), contact_at(height));
    belief.update();
  }

  ResolvedConfig config;
  std::unique_ptr<const Scene> scene;
  Context context;
  Candidates candidates;
  PhaseClock clock;
  TapBelief belief;
};

TEST(TwoPart, IsTheObjectFromAWeightOfOneHalfOnAndTheDeskBelow) {
  // Far from the only tap, at this length scale, the weight is its prior mean and the height the level of the object.
  const auto with = [](const std::string& prior_mean) {
    return std::vector<std::string>{"surface=two_part", "kernel.length_scale=0.1mm", "scene.desk=-30cm",
                                    "label.prior_mean=" + prior_mean};
  };
  Alone object(with("0.5"));
  Alone desk(with("0.49999999"));
  for (Alone* one : {&object, &desk}) one->touch(40, -0.21);
  // The level is learnt from a tap of variance 1 + 1e-8 against its own prior of a million.
  const double level = -0.30 + 0.09 * 1e6 / (1e6 + 1.0 + 1e-8);
  EXPECT_NEAR(reconstruction(object.belief)(0), level, 1e-12);
  EXPECT_EQ(reconstruction(desk.belief)(0), -0.30);
  EXPECT_NEAR(desk.belief.height_mean()(0), level, 1e-12) << "the height itself is not gated";
  EXPECT_NEAR(reconstruction(desk.belief)(40), -0.21, 1e-7) << "where it was touched it is an object";
}

TEST(TwoPart, IsADeskWhileNothingWasHit) {
  Alone one({"surface=two_part"});
  one.touch(3, 0.0);
  one.touch(50, 0.0);
  EXPECT_TRUE((reconstruction(one.belief).array() == 0.0).all());
  EXPECT_EQ(one.belief.surface_gp().process->size(), 0);
  EXPECT_EQ(one.belief.label_gp().process->size(), 2);
}

TEST(TwoPart, TakesHeightsFromTapsOnAnObjectAloneWithAFreeLevel) {
  Alone one({"surface=two_part", "kernel.length_scale=3cm"});
  const std::vector<std::pair<int, double>> taps{{10, 0.0}, {30, 0.08}, {33, 0.0}, {40, 0.1}, {42, 0.09}, {77, 0.0}};
  for (const auto& [candidate, height] : taps) one.touch(candidate, height);

  // A free level is a constant of that variance in every covariance.
  Textbook<long double> book(
      [](const Target& a, const Target& b) {
        const long double square = (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
        return 1e6L + std::exp(-0.5L * square / (0.03L * 0.03L));
      },
      1e-8L, one.candidates.points);
  for (const auto& [candidate, height] : taps) {
    if (height > 0.0) book.add(one.candidates.target(candidate), {height});
  }
  // The oracle takes differences of a million in 19 digits, with a matrix of condition 1e7.
  EXPECT_LT(apart(one.belief.height_mean(), book.mean()), 1e-10);
  EXPECT_LT(apart(one.belief.height_variance(), book.variance()), 1e-5);
  one.belief.ask(Quantity::uncertainty);
  EXPECT_EQ(one.belief.height_gp().process->size(), 6) << "u comes from all taps";
}

TEST(TwoPart, ChoosesTheVeryTapsOfASinglePart) {
  for (const char* acquisition : {"random", "grid", "uncertainty", "weighted"}) {
    const std::string strategy = std::string("acquisition=") + acquisition;
    const Finished single("paper/object_i.yaml", {strategy, "surface=single"});
    const Finished parted("paper/object_i.yaml", {strategy, "surface=two_part"});
    ASSERT_EQ(single.taps.size(), parted.taps.size());
    for (std::size_t i = 0; i < single.taps.size(); ++i) {
      EXPECT_EQ(single.taps[i].candidate, parted.taps[i].candidate) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(single.taps[i].score, parted.taps[i].score) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(single.taps[i].uncertainty, parted.taps[i].uncertainty) << acquisition << ", tap " << i + 1;
    }
  }
}

TEST(TwoPart, IsNotBuiltForTheRecordOfATapNorForItsMaps) {
  Prepared prepared("paper/object_i_right.yaml", {"seed=3", "surface=two_part"});
  std::string maps;  // written at every tap, as by log.maps
  prepared.journal.announcing = [&](const TapRecord&) { maps = maps_csv(prepared.experiment); };
  prepared.run();
  for (const TapRecord& tap : prepared.taps) {
    EXPECT_FALSE(tap.surface_gp || tap.errors.rmse || tap.errors.rmse_object || tap.errors.rmse_height);
    EXPECT_EQ(tap.max_standard_deviation.has_value(), tap.height_gp.has_value());
    EXPECT_EQ(tap.errors.footprint_iou.has_value(), tap.label_gp.has_value());
  }
  EXPECT_TRUE(prepared.taps.back().height_gp && prepared.taps.back().label_gp);
  EXPECT_EQ(maps.substr(0, maps.find('\n')), "x,y,u,w");
}

TEST(TwoPart, IsInTheRecordOfATapOnceSomebodyAsksForIt) {
  Prepared prepared("paper/object_i_right.yaml", {"seed=3", "surface=two_part"});
  prepared.experiment.ask(Quantity::height);
  prepared.run();
  const TapRecord& tap = prepared.taps.back();
  ASSERT_TRUE(tap.surface_gp && tap.errors.rmse && tap.errors.rmse_height);
  EXPECT_EQ(tap.surface_gp->settings.mean_ratio, 1000.0);
  EXPECT_EQ(maps_csv(prepared.experiment).substr(0, 31), "x,y,height_mean,height_variance");
}

TEST(TwoPart, StopsAtTheVeryTapThatTheSingleSurfaceStopsAt) {
  const auto taps = [](const std::string& surface) {
    Finished run("paper/object_i.yaml", {"acquisition=uncertainty", "kernel.length_scale=13 cm", "taps=100",
                                         "stop.max_standard_deviation=10 cm", "surface=" + surface});
    EXPECT_EQ(run.experiment.result().stop_reason, "max_standard_deviation");
    return run.taps.size();
  };
  EXPECT_EQ(taps("single"), taps("two_part"));
}

}  // namespace
}  // namespace palpate::test
