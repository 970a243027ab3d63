// SPDX-License-Identifier: MIT
// `surface: two_part`: heights from the taps on an object alone, gated by the weight.
#include "experiment/metrics.hpp"
#include "record/summary.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>

namespace palpate {
namespace {

using test::Collector;
using test::shipped_config;

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
    belief.observe(candidates.target(candidate), {Outcome::contact, height, 8.0, 1.0, {}});
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
  const std::vector<std::string> common{"surface=two_part", "kernel.length_scale=0.1mm", "scene.desk=-30cm"};
  std::vector<std::string> at_half = common;
  at_half.emplace_back("weight.prior_mean=0.5");
  std::vector<std::string> below = common;
  below.emplace_back("weight.prior_mean=0.49999999");
  Alone object(at_half);
  Alone desk(below);
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
  EXPECT_EQ(one.belief.surface_process().process->size(), 0);
  EXPECT_EQ(one.belief.weight_process().process->size(), 2);
}

TEST(TwoPart, TakesHeightsFromTapsOnAnObjectAloneWithAFreeLevel) {
  Alone one({"surface=two_part", "kernel.length_scale=3cm"});
  const std::vector<std::pair<int, double>> taps{{10, 0.0}, {30, 0.08}, {33, 0.0}, {40, 0.1}, {42, 0.09}, {77, 0.0}};
  for (const auto& [candidate, height] : taps) one.touch(candidate, height);

  Points on(3, 2);
  Eigen::Vector3d heights;
  Eigen::Index next = 0;
  for (const auto& [candidate, height] : taps) {
    if (height == 0.0) continue;
    on.row(next) = one.candidates.points.row(candidate);
    heights(next++) = height;
  }
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const auto prior = [](const Points& a, const Points& b) {
    Wide k(a.rows(), b.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        k(i, j) = 1e6L + std::exp(-0.5L * (a.row(i) - b.row(j)).squaredNorm() / (0.03 * 0.03));
      }
    }
    return k;
  };
  const Wide inverse = (prior(on, on) + 1e-8L * Wide::Identity(3, 3)).inverse();
  const Wide cross = prior(on, one.candidates.points);
  const Eigen::VectorXd mean = (cross.transpose() * inverse * heights.cast<long double>()).cast<double>();
  const Wide explained = (cross.transpose() * inverse * cross).diagonal();
  const Eigen::VectorXd variance = (1e6L + 1.0L - explained.array()).cast<double>();
  // The oracle takes differences of a million in 19 digits, with a matrix of condition 1e7.
  EXPECT_LT((one.belief.height_mean() - mean).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((one.belief.height_variance() - variance).cwiseAbs().maxCoeff(), 1e-5);
  one.belief.ask(Quantity::uncertainty);
  EXPECT_EQ(one.belief.height_process().process->size(), 6) << "u comes from all taps";
}

TEST(TwoPart, ChoosesTheVeryTapsOfASinglePart) {
  for (const char* acquisition : {"random", "grid", "uncertainty", "weighted"}) {
    std::vector<Collector> runs(2);
    for (std::size_t i = 0; i < 2; ++i) {
      const ResolvedConfig config =
          shipped_config("paper/object_i.yaml",
                         {std::string("acquisition=") + acquisition, i == 0 ? "surface=single" : "surface=two_part"});
      Experiment experiment(config.options, test::shared_host(), nullptr);
      experiment.run(runs[i]);
    }
    ASSERT_EQ(runs[0].taps.size(), runs[1].taps.size());
    for (std::size_t i = 0; i < runs[0].taps.size(); ++i) {
      EXPECT_EQ(runs[0].taps[i].candidate, runs[1].taps[i].candidate) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(runs[0].taps[i].score, runs[1].taps[i].score) << acquisition << ", tap " << i + 1;
      EXPECT_EQ(runs[0].taps[i].uncertainty, runs[1].taps[i].uncertainty) << acquisition << ", tap " << i + 1;
    }
  }
}

/// Writes the maps at every tap, as log.maps does.
class Mapper final : public Journal {
 public:
  explicit Mapper(Experiment& experiment) : experiment_(experiment) {}
  std::vector<TapRecord> taps;
  std::string last;
  void announce(const TapRecord&) override { last = maps_csv(experiment_); }
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { taps.push_back(tap); }

 private:
  Experiment& experiment_;
};

TEST(TwoPart, IsNotBuiltForTheRecordOfATapNorForItsMaps) {
  const ResolvedConfig config = shipped_config("paper/object_i_right.yaml", {"seed=3", "surface=two_part"});
  Experiment experiment(config.options, test::shared_host(), nullptr);
  Mapper mapper(experiment);
  experiment.run(mapper);
  for (const TapRecord& tap : mapper.taps) {
    EXPECT_FALSE(tap.surface_process || tap.errors.rmse || tap.errors.rmse_on_surface || tap.errors.rmse_height);
    EXPECT_EQ(tap.max_standard_deviation.has_value(), tap.height_process.has_value());
    EXPECT_EQ(tap.errors.footprint_iou.has_value(), tap.weight_process.has_value());
  }
  EXPECT_TRUE(mapper.taps.back().height_process && mapper.taps.back().weight_process);
  EXPECT_EQ(mapper.last.substr(0, mapper.last.find('\n')), "x,y,u,w");
}

TEST(TwoPart, IsInTheRecordOfATapOnceSomebodyAsksForIt) {
  const ResolvedConfig config = shipped_config("paper/object_i_right.yaml", {"seed=3", "surface=two_part"});
  Experiment experiment(config.options, test::shared_host(), nullptr);
  experiment.ask(Quantity::height);
  Collector collector;
  experiment.run(collector);
  const TapRecord& tap = collector.taps.back();
  ASSERT_TRUE(tap.surface_process && tap.errors.rmse && tap.errors.rmse_height);
  EXPECT_EQ(tap.surface_process->settings.mean_ratio, 1000.0);
  EXPECT_EQ(maps_csv(experiment).substr(0, 31), "x,y,height_mean,height_variance");
}

TEST(TwoPart, StopsAtTheVeryTapThatTheSingleSurfaceStopsAt) {
  const auto taps = [](const std::string& surface) {
    const ResolvedConfig config =
        shipped_config("paper/object_i.yaml", {"acquisition=uncertainty", "kernel.length_scale=13 cm", "taps=100",
                                               "stop.max_standard_deviation=10 cm", "surface=" + surface});
    Experiment experiment(config.options, test::shared_host(), nullptr);
    test::Collector collector;
    experiment.run(collector);
    EXPECT_EQ(experiment.result().stop_reason, "max_standard_deviation");
    return collector.taps.size();
  };
  EXPECT_EQ(taps("single"), taps("two_part"));
}

TEST(TwoPart, ErrorsOfARunAreThoseOfTheGatedSurface) {
  const ResolvedConfig config = shipped_config("paper/object_i_right.yaml", {"seed=3", "surface=two_part"});
  Experiment experiment(config.options, test::shared_host(), nullptr);
  Collector collector;
  experiment.run(collector);
  const RunResult result = experiment.result();
  const TapBelief& belief = experiment.belief();
  const Truth& truth = *experiment.truth();
  double all = 0.0;
  double on = 0.0;
  double bare = 0.0;
  int gated = 0;
  for (Eigen::Index i = 0; i < truth.height.size(); ++i) {
    const bool object = belief.weight_mean()(i) >= 0.5;
    gated += object ? 1 : 0;
    const double error = (object ? belief.height_mean()(i) : 0.0) - truth.height(i);
    all += error * error;
    if (!truth.on(i)) continue;
    on += error * error;
    bare += std::pow(belief.height_mean()(i) - truth.height(i), 2);
  }
  EXPECT_GT(gated, 0);
  EXPECT_LT(gated, experiment.candidates().size());
  const auto count_on = static_cast<double>(truth.on.count());
  EXPECT_NEAR(*result.errors.rmse, std::sqrt(all / experiment.candidates().size()), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_on_surface, std::sqrt(on / count_on), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_height, std::sqrt(bare / count_on), 1e-12);
  EXPECT_NE(*result.errors.rmse_height, *result.errors.rmse_on_surface);
  EXPECT_TRUE(result.calibration.nlpd.has_value());
}

}  // namespace
}  // namespace palpate
