// SPDX-License-Identifier: MIT
// What a run counts of the factorisations of its models: each once, and jitter is a variance, never a count.
#include "regular/factor_diagnostics.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

TEST(Diagnostics, CountATapThatSeveralModelsSetAsideOnce) {
  BeliefState state;
  count_factors(state, FactorReport{1e-9, 2, 1, 3});
  count_factors(state, FactorReport{1e-6, 1, 4, 2});
  EXPECT_EQ(state.diagnostics.at("jitter"), 3);
  EXPECT_EQ(state.diagnostics.at("pivoted"), 5);
  EXPECT_EQ(state.diagnostics.at("redundant_taps"), 3);
  EXPECT_EQ(state.jitter_max, 1e-6);
}

TEST(Diagnostics, CountAProcessOfHeightsAndLabelsOnce) {
  const std::vector<TapResult> answers(6, contact_at(0.05));
  Finished run("default.yaml",
               {"belief.label.hyperparameters=shared", "belief.surface=single",
                "belief.height.outlier_probability=none", "belief.footprint=gp_regression", "belief.height.noise=0mm",
                "candidates.count=1", "choice.repeat=allow", "taps=6"},
               scripted(answers));
  run.read({quantity::kLabelMean, quantity::kHeightMean});
  const RunResult result = run.experiment.result();
  const GaussianProcess* const process = run.models().gps().height.process;
  ASSERT_NE(process, nullptr);
  ASSERT_EQ(run.models().gps().label.process, process);
  const int raised = process->diagnostics().factors.raised;
  ASSERT_GT(raised, 0);
  EXPECT_EQ(result.state.diagnostics.at("jitter"), raised);
}

/// A footprint that factorises something.
struct Factorising final : Footprint {
  void add(const Touch&) override {}
  void probability(const PointsView&, VectorOut out) override { out.setConstant(0.5); }
  std::vector<FootprintNumber> numbers() const override {
    return {{"jitter", 0.25}, {"jitter_raised", 3.0}, {"pivoted", 2.0}, {"redundant_taps", 1.0}};
  }
};

TEST(Diagnostics, TakeTheNumbersOfAFootprintByTheirNames) {
  const Instead<Footprint> plugins(std::make_shared<Factorising>());
  Finished run("default.yaml", {"taps=4"}, scripted(std::vector<TapResult>(4, contact_at(0.05))), plugins);
  const RunResult result = run.experiment.result();
  EXPECT_EQ(result.state.diagnostics.at("jitter"), 3);
  EXPECT_EQ(result.state.diagnostics.at("pivoted"), 2);
  EXPECT_EQ(result.state.diagnostics.at("redundant_taps"), 1);
  EXPECT_EQ(result.state.jitter_max, 0.25);
}

/// No covariance: all pairs vary more with each other than by themselves.
struct Impossible final : Kernel {
  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) out(i, j) = a.row(i) == b.row(j) ? 1.0 : 3.0;
    }
  }
  void variance(const PointsView&, VectorOut out) const override { out.setOnes(); }
  std::vector<KernelParameter> parameters() const override { return {}; }
};

TEST(Diagnostics, OfTheClassifierTellJitterAsAVarianceAndItsCountBeside) {
  const Instead<Kernel> plugins(std::make_shared<Impossible>());
  Finished run("default.yaml",
               {"belief.footprint=gp_classifier", "belief.engine.type=dense", "acquisition=random", "taps=6"},
               scripted({contact_at(0.05), contact_at(0.0), contact_at(0.05), contact_at(0.05)}), plugins);
  run.read({quantity::kObjectProbability, quantity::kHeightMean});
  const RunResult result = run.experiment.result();
  const auto number = [&](const std::string& name) {
    return number_of(result.state, "footprint." + name).value_or(std::nan(""));
  };
  EXPECT_GE(number("jitter_raised"), 1.0);
  EXPECT_GT(number("jitter"), 0.0);
  EXPECT_LT(number("jitter"), 1e-9) << "nobody sees that";
}

}  // namespace
}  // namespace palpate::test
