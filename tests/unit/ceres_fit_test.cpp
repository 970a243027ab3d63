// SPDX-License-Identifier: MIT
// The fitting plugin `ceres` on data whose optimum several independent optimisers agree on (tests/data/fit_N.csv).
#include "support/fit_data.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
  EXPECT_EQ(found_from_bad_starts("{priors: none, starts: 4}"), 20);
}

}  // namespace
}  // namespace palpate::test
