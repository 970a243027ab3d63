// SPDX-License-Identifier: MIT
// The fitting plugin `ceres` on data whose optimum several independent optimisers agree on (tests/data/fit_N.csv).
#include "support/fit_data.hpp"
#include "support/sanitizers.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <fstream>

namespace palpate::test {
namespace {

struct Optimum {
  int points;
  double log_marginal_likelihood;
};

void PrintTo(const Optimum& optimum, std::ostream* out) { *out << optimum.points << " points"; }

std::shared_ptr<Fitting> ceres(const std::string& options) { return make<Fitting>(contract_host(), "ceres", options); }

class CeresOptimum : public testing::TestWithParam<Optimum> {};

TEST_P(CeresOptimum, IsReachedFromTheReferenceStart) {
  const FitData data = fit_data(GetParam().points);
  FitState state;
  const FitSummary summary = state.fit(*ceres("{priors: none, starts: 1}"), data);
  EXPECT_TRUE(summary.changed) << summary.reason;
  const double truth = GetParam().log_marginal_likelihood;
  EXPECT_NEAR(summary.objective, truth, 1e-6 * truth + 5e-5) << summary.reason;  // the reference has four decimals
}

INSTANTIATE_TEST_SUITE_P(Reference, CeresOptimum,
                         testing::Values(Optimum{50, 45.7165}, Optimum{200, 418.6733}, Optimum{1000, 2899.6743}),
                         [](const auto& one) { return std::to_string(one.param.points); });

/// Hyperparameters log-uniform within a factor of 100 of the optimum's.
FitState bad_start(Random& random) {
  const auto factor = [&] { return std::pow(10.0, 4.0 * random.uniform() - 2.0); };
  FitState best;
  best.fit(*ceres("{priors: none}"), fit_data(50));
  const double signal = best.signal * best.signal;
  const double noise = best.noise_ratio * best.noise_ratio * signal;
  const double length = best.length_scale() * factor();
  const double start = signal * factor();
  return FitState(length, start, noise * factor());
}

int found_from_bad_starts(const std::string& options) {
  const FitData data = fit_data(50);
  Random random(20, "bad starts");
  int found = 0;
  for (int i = 0; i < 20; ++i) {
    FitState state = bad_start(random);
    const FitSummary summary = state.fit(*ceres(options), data, static_cast<std::uint64_t>(i));
    found += std::abs(summary.objective - 45.7165) < 1e-4 ? 1 : 0;
  }
  return found;
}

TEST(CeresFit, FindsTheOptimumFromNineteenOfTwentyBadStarts) {
  const int found = found_from_bad_starts("{priors: none, starts: 1}");
  RecordProperty("found", found);
  EXPECT_GE(found, 19);
}

TEST(CeresFit, FindsTheOptimumFromEveryBadStartWithSeveralAscents) {
  EXPECT_EQ(found_from_bad_starts("{priors: none}"), 20);
}

/// Taps of a flat object 5 cm above the desk, the first `on` of `count` on it.
FitData few_taps(int count, int on) {
  Random random(6, "few taps");
  FitData data{Points(count, 2), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    data.points.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
    data.targets(i) = i < on ? 0.05 + 0.002 * random.uniform() : 0.0;
  }
  return data;
}

TEST(CeresFit, StaysReasonableWithOneToThreeTaps) {
  for (const std::string measure : {"lml", "loo"}) {
    for (int count = 1; count <= 3; ++count) {
      for (int on = 1; on <= count; ++on) {
        FitState state;
        const FitSummary summary = state.fit(*ceres("{objective: " + measure + "}"), few_taps(count, on));
        SCOPED_TRACE(measure + ", " + std::to_string(count) + " taps: " + summary.reason);
        EXPECT_TRUE(summary.changed);
        EXPECT_GT(state.length_scale(), 0.005);  // no collapse to pure noise ...
        EXPECT_LT(state.noise_ratio, 1.0);
        EXPECT_LT(state.length_scale(), 0.23);  // ... and no length scale at infinity
        EXPECT_GT(state.signal, 0.02);
        EXPECT_LT(state.signal, 0.2);
      }
    }
  }
}

TEST(CeresFit, KeepsTheOldValuesWhenTheTapsTellNothing) {
  FitState state(0.02, 4.0, 1e-2);
  const FitSummary summary = state.fit(*ceres("{}"), few_taps(5, 0));
  EXPECT_FALSE(summary.changed);
  EXPECT_FALSE(summary.failed);
  EXPECT_EQ(summary.reason, "the targets equal the mean and contain no information");
  EXPECT_EQ(state.signal, 2.0);
  EXPECT_EQ(state.length_scale(), 0.02);
}

TEST(CeresFit, WantsMoreTapsThanHyperparametersWithoutPriors) {
  FitState state;
  const FitSummary summary = state.fit(*ceres("{priors: none}"), few_taps(3, 2));
  EXPECT_FALSE(summary.changed);
  EXPECT_EQ(summary.reason, "without priors there must be more taps than hyperparameters");
}

TEST(CeresFit, IsAtRestWhenItMeetsTheSameTapsAgain) {
  const FitData data = fit_data(50);
  for (const char* options : {"{}", "{mean: fit}", "{objective: loo}"}) {
    FitState state;
    const FitSummary first = state.fit(*ceres(options), data);
    const double length = state.length_scale();
    const double signal = state.signal;
    const double mean = state.mean;
    const FitSummary second = state.fit(*ceres(options), data);
    EXPECT_NEAR(second.objective, first.objective, 1e-5 * std::abs(first.objective)) << options;
    EXPECT_GE(second.objective, first.objective - 1e-9 * std::abs(first.objective)) << options;
    EXPECT_NEAR(state.length_scale(), length, 1e-2 * length) << options;
    EXPECT_NEAR(state.signal, signal, 1e-2 * signal) << options;
    EXPECT_NEAR(state.mean, mean, 1e-2 * signal) << options;
  }
}

// Once the mean was found, what is left is small; the next fit must not take that for the size of everything.
TEST(CeresFit, KeepsTheMeanOfAPlateauThatItHasFound) {
  FitState state;
  for (int count = 2; count <= 40; ++count) {
    FitData data = few_taps(count, count);
    data.targets = 0.1 + 1e-4 * (40.0 * data.points.col(0).array()).sin();
    const FitSummary summary = state.fit(*ceres("{mean: fit}"), data);
    EXPECT_FALSE(summary.failed) << summary.reason;
    EXPECT_NEAR(state.mean, 0.1, 3e-4) << count << " taps: " << summary.reason;
    EXPECT_LT(state.signal, 1e-3) << count << " taps";
  }
}

/// A fit of two outputs without priors: `others` at the places of `data`, whose signal goes to `signal`, and `data`.
FitSummary fit_with_another(FitState& state, const FitData& data, const Eigen::VectorXd& others, double& signal) {
  double mean = 0.0;
  FitProblem problem{data.points,
                     *state.kernel,
                     state.noise_ratio,
                     0.0,
                     {{others, signal, mean}, {data.targets, state.signal, state.mean}}};
  Random random(1, "fit");
  return ceres("{priors: none}")->fit(problem, random);
}

/// Taps of an object that stands on a desk: tests/data/taps_w2.csv.
FitData taps_of_a_step() {
  std::ifstream file(source_folder() / "tests/data/taps_w2.csv");
  std::string line;
  std::getline(file, line);
  FitData out{Points(200, 2), Eigen::VectorXd(200)};
  char comma = ',';
  for (int i = 0; i < 200; ++i) {
    file >> out.points(i, 0) >> comma >> out.points(i, 1) >> comma >> out.targets(i) >> comma >> line;
  }
  out.points *= 0.01;
  return out;
}

TEST(CeresFit, AfterOneMoreTapIsAsLikelyAsASearchFromTheSameValuesForMuchLess) {
  for (const FitData& data : {fit_data(200), taps_of_a_step()}) {
    const auto fitting = ceres("{}");
    FitState state;
    std::vector<double> memory;
    int fits = 0;
    int worse = 0;
    int cost = 0;
    int cost_of_searches = 0;
    double worst = 0.0;
    for (Eigen::Index taps = 6; taps <= (brief() ? 60 : 200); ++taps) {
      const FitData some{data.points.topRows(taps), data.targets.head(taps)};
      FitState cold(state.length_scale(), state.signal * state.signal,
                    state.noise_ratio * state.noise_ratio * state.signal * state.signal);
      const auto seed = static_cast<std::uint64_t>(taps);
      const FitSummary search = cold.fit(*fitting, some, seed);
      const FitSummary refit = state.fit(*fitting, some, seed, &memory);
      ++fits;
      worse += refit.objective < search.objective - 1e-3 ? 1 : 0;
      worst = std::max(worst, search.objective - refit.objective);
      cost += refit.evaluations;
      cost_of_searches += search.evaluations;
    }
    RecordProperty("worse", worse);
    EXPECT_LE(worse, fits / 100) << "of " << fits << ", by up to " << worst;
    EXPECT_LT(cost, 0.5 * cost_of_searches);
  }
}

TEST(CeresFit, WithoutPriorsSearchesEveryTime) {
  std::vector<double> memory;
  FitState state;
  for (int i = 0; i < 2; ++i) {
    const FitSummary summary = state.fit(*ceres("{priors: none}"), fit_data(50), 1, &memory);
    EXPECT_NE(summary.reason.find("3 starts"), std::string::npos) << summary.reason;
  }
}

TEST(CeresFit, LeftWithNumbersOfOtherOutputsSearches) {
  std::vector<double> memory;
  FitState state;
  state.fit(*ceres("{}"), fit_data(50), 1, &memory);
  ASSERT_EQ(memory.size(), 10U);
  FitState again = state;
  std::vector<double> of_others(5, 50.0);
  const FitSummary summary = again.fit(*ceres("{}"), fit_data(50), 1, &of_others);
  EXPECT_NE(summary.reason.find("3 starts"), std::string::npos) << summary.reason;
  EXPECT_EQ(of_others.size(), 10U);
}

TEST(CeresFit, LeavesOutAnOutputWhoseTargetsAreAllAlike) {
  const FitData data = fit_data(50);
  FitState state;
  double signal = 1.0;
  const FitSummary summary = fit_with_another(state, data, Eigen::VectorXd::Zero(50), signal);
  EXPECT_TRUE(summary.changed);
  EXPECT_NEAR(summary.objective, 45.7165, 1e-4);
  EXPECT_NE(summary.reason.find("outputs without information were left out"), std::string::npos) << summary.reason;
  EXPECT_EQ(signal, 1.0);
}

/// A kernel that fits work with, but whose covariances are no numbers.
class Broken final : public Kernel {
 public:
  void covariance(const PointsView&, const PointsView&, MatrixOut out) const override { out.setConstant(std::nan("")); }
  void variance(const PointsView&, VectorOut out) const override { out.setConstant(std::nan("")); }
  std::vector<KernelParameter> parameters() const override { return {{"length_scale", value_, Unit::metre}}; }
  bool differentiable() const override { return true; }
  void set_parameters(const VectorView& values) override { value_ = values(0); }
  void derivatives(const PointsView&, const PointsView&, MatrixOut value, MatrixOut slopes) const override {
    value.setConstant(std::nan(""));
    slopes.setConstant(std::nan(""));
  }

 private:
  double value_ = 0.017;
};

TEST(CeresFit, ThatFailsKeepsTheOldValuesAndSaysWhy) {
  FitState state;
  state.kernel = std::make_shared<Broken>();
  for (const int count : {12, 200}) {
    const FitSummary summary = state.fit(*ceres("{}"), few_taps(count, 6));
    EXPECT_FALSE(summary.changed);
    EXPECT_TRUE(summary.failed);
    EXPECT_EQ(summary.reason, "no ascent reached a finite value");
    EXPECT_EQ(state.length_scale(), 0.017);
    EXPECT_EQ(state.signal, 1.0);
  }
}

TEST(CeresFit, SharesOneKernelAmongOutputsAndGivesEachItsSignal) {
  const FitData data = fit_data(50);
  FitState alone;
  alone.fit(*ceres("{priors: none}"), data);
  // The same targets ten times as large: kernel and noise ratio are those of one output, the signal ten times.
  FitState both;
  double signal = 1.0;
  ASSERT_TRUE(fit_with_another(both, data, 10.0 * data.targets, signal).changed);
  EXPECT_NEAR(both.length_scale(), alone.length_scale(), 1e-3 * alone.length_scale());
  EXPECT_NEAR(both.noise_ratio, alone.noise_ratio, 1e-2 * alone.noise_ratio);
  EXPECT_NEAR(both.signal, alone.signal, 1e-2 * alone.signal);
  EXPECT_NEAR(signal, 10.0 * both.signal, 1e-2 * signal);
}

TEST(CeresFit, FindsTheConstantMean) {
  FitData data = fit_data(200);
  data.targets.array() += 3.0;
  FitState state;
  state.mean = 2.5;
  ASSERT_TRUE(state.fit(*ceres("{priors: none, mean: fit}"), data).changed);
  EXPECT_NEAR(state.mean, 3.0, 0.15);
  EXPECT_NEAR(state.signal, 0.31, 0.05);
  FitState kept;
  kept.mean = 2.5;
  kept.fit(*ceres("{priors: none}"), data);
  EXPECT_EQ(kept.mean, 2.5);
}

TEST(CeresFit, IsDueEveryFewTaps) {
  const auto fitting = ceres("{every: 5}");
  for (int taps = 0; taps < 30; ++taps) EXPECT_EQ(fitting->due(taps), taps > 0 && taps % 5 == 0) << taps;
}

}  // namespace
}  // namespace palpate::test
