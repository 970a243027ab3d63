// SPDX-License-Identifier: MIT
// What the engine `lowrank` may lose, and which engine `auto` takes.
#include "unit/engine_data.hpp"

#include <fmt/format.h>

namespace palpate::test {
namespace {

TEST(LowrankEngine, StaysWithinItsOwnErrorBoundForAnyTolerance) {
  const Data data = draw(60);
  const CandidateGrid candidates = grid(40, 40);
  const GaussianProcess exact = processed(data, candidates, settings_of(Kind::dense));
  for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
    EngineSettings settings = settings_of(Kind::lowrank);
    settings.tolerance = tolerance;
    const GaussianProcess process = processed(data, candidates, settings);
    const double rounding = 1e-12;
    const double error =
        std::max({apart(process.mean(0), exact.mean(0)) / 2.0, apart(process.mean(1), exact.mean(1)) / 0.5,
                  apart(process.relative_variance(), exact.relative_variance())});
    EXPECT_LE(error, process.engine().error_bound + rounding) << tolerance;
    EXPECT_GT(process.engine().error_bound, 0.0);
    if (tolerance > 1e-8) {
      EXPECT_GT(error, 1e-3 * process.engine().error_bound) << "a bound that tells something";
    }
  }
}

TEST(LowrankEngine, TellsItsErrorInPriorStandardDeviationsWhateverThePrior) {
  const Data data = draw(20);
  const CandidateGrid candidates = grid(40, 40);
  EngineSettings settings = settings_of(Kind::lowrank);
  settings.tolerance = 1e-7;
  std::vector<double> bounds;
  for (const double factor : {1e-4, 1.0, 1e4}) {
    const std::string options = fmt::format("{{factor: {}, kernel: {{type: rbf, length_scale: 3 cm}}}}", factor);
    const auto kernel = test::make<Kernel>(test::shared_host(), "scale", options);
    const double deviation = std::sqrt(factor);
    const GpSettings output{1.0, 0.05 * deviation, 0.0, 0.0};
    GaussianProcess exact(kernel, output, candidates, settings_of(Kind::dense));
    GaussianProcess process(kernel, output, candidates, settings);
    for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
      for (GaussianProcess* one : {&exact, &process}) {
        one->add({data.places(i, 0), data.places(i, 1)}, deviation * data.values(i, 0));
      }
    }
    EXPECT_LE(apart(process.mean(), exact.mean()) / deviation, process.engine().error_bound) << factor;
    EXPECT_LE(apart(process.variance(), exact.variance()) / factor, process.engine().error_bound) << factor;
    bounds.push_back(process.engine().error_bound);
  }
  EXPECT_NEAR(bounds[0], bounds[1], 1e-3 * bounds[1]);
  EXPECT_NEAR(bounds[2], bounds[1], 1e-3 * bounds[1]);
}

TEST(LowrankEngine, OfTapsOnCandidatesKeepsTwelveDigits) {
  Data data = draw(60);
  const CandidateGrid candidates = grid(40, 40);
  Random random(3, "engine_test/places");
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    const Target place =
        candidates.target(static_cast<int>(random.index(static_cast<std::uint64_t>(candidates.size()))));
    data.places.row(i) << place.x, place.y;
  }
  const GaussianProcess exact = processed(data, candidates, settings_of(Kind::dense));
  const GaussianProcess process = processed(data, candidates, settings_of(Kind::lowrank));
  EXPECT_LT(apart(process.relative_variance(), exact.relative_variance()), 1e-12);
  EXPECT_LT(apart(process.mean(0), exact.mean(0)), 1e-10);
  EXPECT_LT(process.engine().error_bound, 1e-9);
}

TEST(AutomaticEngine, TakesWhatServesAndSaysWhy) {
  const CandidateGrid square = grid(30, 30);
  const CandidateGrid any = scattered(Points::Random(20, 2));
  const auto matern = test::make<Kernel>(test::shared_host(), "matern32");
  const auto engine = [](const std::shared_ptr<Kernel>& kernel, const CandidateGrid& candidates, int taps,
                         double accuracy) {
    EngineSettings settings;
    settings.taps = taps;
    settings.accuracy = accuracy;
    const GaussianProcess process(kernel, kOutputs, candidates, settings);
    return std::string(process.engine().name) + ": " + process.engine().reason;
  };
  EXPECT_EQ(engine(matern, square, 300, 1e-9), "dense: the kernel is not separable");
  EXPECT_EQ(engine(rbf(), any, 300, 1e-9), "dense: the candidates are not a product grid");
  EXPECT_EQ(engine(rbf(), square, 300, 0.0), "dense: no error is allowed");
  EXPECT_EQ(engine(rbf(), square, 17, 1e-9), "grid: separable kernel on a grid and 17 taps");
  // Along y, there is a direction for every row.
  const auto rough = rbf("{length_scale: 1 m, length_scale_y: 0.1 mm}");
  EXPECT_EQ(engine(rough, grid(30, 400), 100, 1e-9), "grid: separable kernel of a rank that 100 taps do not reach");
  EXPECT_THAT(engine(rbf(), square, 300, 1e-9),
              testing::MatchesRegex("lowrank: separable kernel of rank .* x .* on a grid and 300 taps"));
}

TEST(AutomaticEngine, LeavesLowrankWhenItsErrorBoundIsAboveTheAccuracy) {
  const Data data = draw(30);
  const CandidateGrid candidates = grid(30, 30);
  EngineSettings settings = settings_of(Kind::automatic);
  settings.taps = 300;
  settings.accuracy = 1e-13;  // some taps keep to it
  GaussianProcess process(rbf(), kOutputs, candidates, settings);
  process.show(2);
  ASSERT_STREQ(process.engine().name, "lowrank");
  add_all(process, data, [&] { EXPECT_LE(process.engine().error_bound, settings.accuracy); });
  EXPECT_STREQ(process.engine().name, "grid");
  EXPECT_THAT(process.engine().reason,
              testing::MatchesRegex("the error bound of lowrank .* is above the accuracy 1.0e-13"));
  expect_same_maps(process, processed(data, candidates, settings_of(Kind::grid)));
}

TEST(Engine, ThatCannotServeIsRefusedWithTheReason) {
  const auto matern = test::make<Kernel>(test::shared_host(), "matern32");
  const CandidateGrid square = grid(3, 3);
  const CandidateGrid any = scattered(Points::Random(20, 2));
  for (const Kind kind : {Kind::grid, Kind::lowrank}) {
    EXPECT_THROW(GaussianProcess(matern, kOutputs, square, settings_of(kind)), Error);
    EXPECT_THROW(GaussianProcess(rbf(), kOutputs, any, settings_of(kind)), Error);
    EXPECT_THAT(objection(settings_of(kind), *matern, square),
                testing::HasSubstr("not a product of a factor along x and a factor along y"));
    EXPECT_THAT(objection(settings_of(kind), *rbf(), any), testing::HasSubstr("product grid"));
    EXPECT_EQ(objection(settings_of(kind), *rbf(), square), "");
  }
}

}  // namespace
}  // namespace palpate::test
