// SPDX-License-Identifier: MIT
// Extremes that come from outside: a backend that reports no number, or numbers of any size.
#include "support/runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Contact touch(double height) { return {Outcome::contact, height, 8.0, 1.0, {}}; }

struct Outside {
  RunResult result;
  test::Collector collected;
};

/// A run in which the taps from the first on answer `heights`, and the desk lies at 0 afterwards.
Outside run(const std::vector<double>& heights, const std::vector<std::string>& overrides) {
  std::vector<Contact> answers;
  for (const double height : heights) answers.push_back(touch(height));
  const ResolvedConfig config = test::shipped_config("paper/object_i.yaml", overrides);
  Experiment experiment(config.options, test::shared_host(), nullptr, std::make_shared<test::ScriptedBackend>(answers));
  Outside out;
  experiment.run(out.collected);
  out.result = experiment.result();
  experiment.ask(Quantity::height | Quantity::weight);
  EXPECT_TRUE(experiment.belief().height_mean().allFinite());
  EXPECT_TRUE(experiment.belief().height_variance().allFinite());
  EXPECT_GE(experiment.belief().height_variance().minCoeff(), 0.0);
  EXPECT_TRUE(experiment.belief().weight_mean().allFinite());
  return out;
}

TEST(ExtremeBackend, EveryKindOfNoNumberIsRefusedAsAFailedTap) {
  const Outside outside = run({std::nan(""), kInfinity, -kInfinity, -std::nan(""), 0.09, 0.0}, {"taps=8"});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(outside.collected.taps[i].contact.outcome, Outcome::aborted);
    EXPECT_THAT(outside.collected.taps[i].contact.reason, ::testing::HasSubstr("not a finite number"));
  }
  EXPECT_EQ(outside.result.failed_taps, 4);
  EXPECT_EQ(outside.result.taps, 8);
  EXPECT_EQ(outside.result.interventions.at("height_refused"), 4);
}

TEST(ExtremeBackend, ARunOfNothingButNoNumbersEndsWithThePrior) {
  const Outside outside = run(std::vector<double>(17, std::nan("")), {});
  EXPECT_EQ(outside.result.failed_taps, 17);
  EXPECT_EQ(outside.result.on_surface_taps, 0);
}

TEST(ExtremeBackend, HeightsOfAnySizeGiveFiniteModels) {
  for (const double height : {1e-9, 1e6, -1e6, 1e150}) {
    const Outside outside = run({height, 0.0, height, 0.0, height}, {"taps=8"});
    EXPECT_EQ(outside.result.failed_taps, 0) << height;
    EXPECT_EQ(outside.result.taps, 8) << height;
  }
}

TEST(ExtremeBackend, RepeatedTapsWithoutNoiseAreMetWithAReportedJitter) {
  const Outside outside = run({}, {"fallback=none", "repeat=allow", "height.noise=0 m", "weight.noise=0"});
  EXPECT_EQ(outside.result.taps, 17);
  EXPECT_GT(outside.result.interventions.at("jitter"), 0);
  EXPECT_EQ(outside.result.interventions.at("pivoted"), 0);
}

}  // namespace
}  // namespace palpate
