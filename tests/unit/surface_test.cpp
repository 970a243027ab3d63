// SPDX-License-Identifier: MIT
// `surface: two_part`: heights from the taps on an object alone, gated by the weight.
#include "belief/metrics.hpp"
#include "record/surface_files.hpp"
#include "support/arrays.hpp"
#include "support/grids.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

namespace palpate::test {
namespace {

/// Models of their own, without a loop around them.
struct Alone {
  explicit Alone(const std::vector<std::string>& overrides)
      : config(shipped_config("paper/object_i.yaml", overrides)),
        scene(build_scene(config.options.scene, 1, test::shared_host())),
        context(test::belief_context(config, *scene)),
        candidates(grid_by_count(scene->area(), 9)),
        models(height_map_options(config.options, test::shared_host()), candidates, context) {
    build({quantity::kHeightMean, quantity::kObjectProbability});
  }

  void build(const QuantitySet& quantities) {
    models.build(models.models_of(quantities));
    update();
  }
  void touch(int candidate, double height) {
    models.add(request_at(candidates.target(candidate)), contact_at(height));
    update();
  }
  void update() {
    models.update();
    models.infer();
  }
  Eigen::VectorXd reconstructed() const {
    return reconstruction({&models.height_mean(), &models.probability(), models.surface().has_value(), scene->desk()});
  }

  ResolvedConfig config;
  std::unique_ptr<const Scene> scene;
  Context context;
  CandidateGrid candidates;
  HeightModels models;
};

TEST(TwoPart, IsTheObjectFromAWeightOfOneHalfOnAndTheDeskBelow) {
  // Far from the only tap, at this length scale, the weight is its prior mean and the height the level of the object.
  const auto with = [](const std::string& prior_mean) {
    return std::vector<std::string>{"belief.surface=two_part", "kernel.length_scale=0.1mm", "scene.desk=-30cm",
                                    "belief.label.prior_mean=" + prior_mean};
  };
  Alone object(with("0.5"));
  Alone desk(with("0.49999999"));
  for (Alone* one : {&object, &desk}) one->touch(40, -0.21);
  // The level is learnt from a tap of variance 1 + 1e-8 against its own prior of a million.
  const double level = -0.30 + 0.09 * 1e6 / (1e6 + 1.0 + 1e-8);
  EXPECT_NEAR(object.reconstructed()(0), level, 1e-12);
  EXPECT_EQ(desk.reconstructed()(0), -0.30);
  EXPECT_NEAR(desk.models.height_mean()(0), level, 1e-12) << "the height itself is not gated";
  EXPECT_NEAR(desk.reconstructed()(40), -0.21, 1e-7) << "where it was touched it is an object";
}

TEST(TwoPart, IsADeskWhileNothingWasHit) {
  Alone one({"belief.surface=two_part"});
  one.touch(3, 0.0);
  one.touch(50, 0.0);
  EXPECT_TRUE((one.reconstructed().array() == 0.0).all());
  EXPECT_EQ(one.models.gps().surface.process->size(), 0);
  EXPECT_EQ(one.models.gps().label.process->size(), 2);
}

TEST(TwoPart, TakesHeightsFromTapsOnAnObjectAloneWithAFreeLevel) {
  Alone one({"belief.surface=two_part", "kernel.length_scale=3cm"});
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
  EXPECT_LT(apart(one.models.height_mean(), book.mean()), 1e-10);
  EXPECT_LT(apart(one.models.height_variance(), book.variance()), 1e-5);
  one.build({quantity::kUncertainty});
  EXPECT_EQ(one.models.gps().height.process->size(), 6) << "u comes from all taps";
}

TEST(TwoPart, ChoosesTheVeryTapsOfASinglePart) {
  for (const char* acquisition : {"random", "grid", "uncertainty", "weighted"}) {
    const std::string strategy = std::string("acquisition=") + acquisition;
    const Finished single("paper/object_i.yaml", {strategy, "belief.surface=single"});
    const Finished parted("paper/object_i.yaml", {strategy, "belief.surface=two_part"});
    ASSERT_EQ(single.taps.size(), parted.taps.size());
    for (std::size_t i = 0; i < single.taps.size(); ++i) {
      EXPECT_EQ(single.taps[i].candidate, parted.taps[i].candidate) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(single.taps[i].score, parted.taps[i].score) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(number_of(single.taps[i].state, "u"), number_of(parted.taps[i].state, "u"))
          << acquisition << ", tap " << i + 1;
    }
  }
}

TEST(TwoPart, IsNotBuiltForTheRecordOfATapNorForItsMaps) {
  Prepared prepared("paper/object_i_right.yaml", {"seed=3", "belief.surface=two_part"});
  std::string maps;  // written at every tap, as by log.maps
  prepared.journal.announcing = [&](const TapRecord& tap) { maps = maps_csv(prepared.belief(), tap.state); };
  prepared.run();
  const auto has = [](const TapRecord& tap, const char* field) { return number_of(tap.state, field).has_value(); };
  for (const TapRecord& tap : prepared.taps) {
    EXPECT_FALSE(has(tap, "surface_gp.signal"));
    EXPECT_FALSE(tap.errors.rmse || tap.errors.rmse_object || tap.errors.rmse_height);
    EXPECT_EQ(has(tap, "max_standard_deviation"), has(tap, "height_gp.signal"));
    EXPECT_EQ(tap.errors.footprint_iou.has_value(), has(tap, "label_gp.signal"));
  }
  EXPECT_TRUE(has(prepared.taps.back(), "height_gp.signal") && has(prepared.taps.back(), "label_gp.signal"));
  EXPECT_EQ(maps.substr(0, maps.find('\n')), "x,y,u,w");
}

TEST(TwoPart, IsInTheRecordOfATapOnceSomebodyAsksForIt) {
  Prepared prepared("paper/object_i_right.yaml", {"seed=3", "belief.surface=two_part"}, nullptr, shared_host(),
                    {quantity::kHeightMean});
  prepared.run();
  const TapRecord& tap = prepared.taps.back();
  ASSERT_TRUE(number_of(tap.state, "surface_gp.signal") && tap.errors.rmse && tap.errors.rmse_height);
  EXPECT_EQ(prepared.models().gps().surface.process->settings().mean_ratio, 1000.0);
  prepared.belief().update();
  prepared.belief().infer();
  const std::string maps = maps_csv(prepared.belief(), prepared.belief().state(0));
  EXPECT_THAT(maps, testing::StartsWith("x,y,height_mean,height_standard_deviation,"));
}

TEST(TwoPart, StopsAtTheVeryTapThatTheSingleSurfaceStopsAt) {
  const auto taps = [](const std::string& surface) {
    Finished run("paper/object_i.yaml", {"acquisition=uncertainty", "kernel.length_scale=13 cm", "taps=100",
                                         "stop.max_standard_deviation=10 cm", "belief.surface=" + surface});
    EXPECT_EQ(run.experiment.result().stop_reason, "max_standard_deviation");
    return run.taps.size();
  };
  EXPECT_EQ(taps("single"), taps("two_part"));
}

}  // namespace
}  // namespace palpate::test
