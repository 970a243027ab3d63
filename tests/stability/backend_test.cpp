// SPDX-License-Identifier: MIT
// Extremes that come from outside: a backend that reports no number, or numbers of any size.
#include "experiment/run_monitor.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A run in which the taps from the first on answer `heights`, and the desk lies at 0 afterwards.
std::unique_ptr<Finished> run(const std::vector<double>& heights, const std::vector<std::string>& overrides) {
  std::vector<TapResult> answers;
  for (const double height : heights) answers.push_back(contact_at(height));
  auto out = std::make_unique<Finished>("paper/object_i.yaml", overrides, scripted(answers));
  out->read({quantity::kHeightMean, quantity::kHeightStd, quantity::kLabelMean});
  const HeightModels& models = out->models();
  EXPECT_TRUE(models.height_mean().allFinite());
  EXPECT_TRUE(models.height_variance().allFinite());
  EXPECT_GE(models.height_variance().minCoeff(), 0.0);
  EXPECT_TRUE(models.label_map().mean().allFinite());
  return out;
}

TEST(ExtremeBackend, EveryKindOfNoNumberIsRefusedAsAFailedTap) {
  const auto outside = run({std::nan(""), kInfinity, -kInfinity, -std::nan(""), 0.09, 0.0}, {"taps=8"});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(outside->taps[i].result.outcome, Outcome::aborted);
    EXPECT_THAT(outside->taps[i].result.reason, ::testing::HasSubstr("not a finite number"));
  }
  EXPECT_EQ(outside->experiment.result().failed_taps, 4);
  EXPECT_EQ(outside->experiment.result().taps, 8);
  EXPECT_EQ(outside->experiment.result().state.diagnostics.at("heights_rejected"), 4);
}

TEST(ExtremeBackend, ARunOfNothingButNoNumbersFailsAfterTenOfThem) {
  Prepared prepared("paper/object_i.yaml", {}, scripted(std::vector<TapResult>(17, contact_at(std::nan("")))));
  EXPECT_EQ(error_of([&] { prepared.run(); }, Error::Kind::run),
            "backend/simulator: 10 taps in a row failed, the last with: the backend reported a height that is not a "
            "finite number, correct the backend");
  EXPECT_EQ(prepared.taps.size(), 10U) << "all are recorded";
  EXPECT_EQ(prepared.experiment.counts().failed_taps, 10);
}

TEST(ExtremeBackend, ATimeOrAForceThatIsNoNumberIsRefusedAsAFailedTap) {
  std::vector<TapResult> answers(3, contact_at(0.05));
  answers[0].seconds = std::nan("");
  answers[1].force = kInfinity;
  answers[2].peak_force = std::nan("");
  Finished outside("paper/object_i.yaml", {"taps=8"}, scripted(answers));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(outside.taps[i].result.reason, kNumberRefused) << i;
  EXPECT_EQ(outside.experiment.result().state.diagnostics.at("heights_rejected"), 3);
  EXPECT_TRUE(std::isfinite(outside.experiment.result().robot_seconds));
}

TEST(ExtremeBackend, AHeightBeyondWhatAModelCanHoldEndsTheRunWithALineThatNamesMapTapAndRemedy) {
  for (const char* const surface : {"single", "two_part"}) {
    std::vector<TapResult> answers;
    for (int i = 0; i < 17; ++i) answers.push_back(contact_at(i % 2 == 0 ? 1.7e308 : -1.7e308));
    const std::string said = error_of(
        [&] {
          Finished run("paper/object_i.yaml", {std::string("belief.surface=") + surface, "kernel.length_scale=5cm"},
                       scripted(answers));
          run.read({quantity::kHeightMean});
        },
        Error::Kind::run);
    EXPECT_THAT(said,
                ::testing::MatchesRegex("maps: the height is not a finite number everywhere after tap [0-9]+, choose a "
                                        "larger belief.height.noise .*"))
        << surface;
  }
  Errors errors;
  errors.rmse = kInfinity;
  EXPECT_THAT(error_of([&] { require_finite(errors, 17); }, Error::Kind::run),
              ::testing::StartsWith("maps: their errors are not finite numbers after tap 17, "));
}

TEST(ExtremeBackend, HeightsOfAnySizeGiveFiniteModels) {
  for (const double height : {1e-9, 1e6, -1e6, 1e150}) {
    const auto outside = run({height, 0.0, height, 0.0, height}, {"taps=8"});
    EXPECT_EQ(outside->experiment.result().failed_taps, 0) << height;
    EXPECT_EQ(outside->experiment.result().taps, 8) << height;
  }
}

TEST(ExtremeBackend, RepeatedTapsWithoutNoiseAreMetWithAReportedJitter) {
  const auto outside =
      run({}, {"choice.fallback=none", "choice.repeat=allow", "belief.height.noise=0 m", "belief.label.noise=0"});
  EXPECT_EQ(outside->experiment.result().taps, 17);
  EXPECT_GT(outside->experiment.result().state.diagnostics.at("jitter"), 0);
  EXPECT_EQ(outside->experiment.result().state.diagnostics.at("pivoted"), 0);
}

}  // namespace
}  // namespace palpate::test
