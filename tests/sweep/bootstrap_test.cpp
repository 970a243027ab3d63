// SPDX-License-Identifier: MIT
// Bootstrap intervals, compared with scipy, with Student's t where it applies, and with their nominal coverage.
#include "analysis/bootstrap.hpp"

#include "support/clusters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace palpate {
namespace {

using test::each_alone;

double width(const MeanInterval& interval) { return interval.high - interval.low; }

/// The ends differ between random streams by about 1 % of the width. The tolerance is three times that, plus the
/// scatter of scipy's own result.
constexpr double kScatter = 0.035;

void expect_near(const std::optional<MeanInterval>& found, const MeanInterval& oracle) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->low, oracle.low, kScatter * width(oracle));
  EXPECT_NEAR(found->high, oracle.high, kScatter * width(oracle));
}

// The interval comes from, with the values as x:
//   n = len(x); z = stats.t.ppf(.975, n - 1) * np.sqrt(n / (n - 1)); c = 1 - 2 * stats.norm.sf(z)
//   stats.bootstrap((x,), np.mean, confidence_level=c, method='BCa', n_resamples=400000, random_state=1)
TEST(BootstrapMean, OfFewSkewedValuesIsTheWidenedBcaIntervalOfScipy) {
  const MeanEstimate mean = bootstrap_mean(each_alone({0.1, 0.3, 0.4, 0.9, 1.1, 1.3, 2.0, 2.2, 3.7, 5.1, 7.9, 16.0}));
  EXPECT_NEAR(mean.mean, 41.0 / 12.0, 1e-12);
  EXPECT_EQ(mean.count, 12U);
  expect_near(mean.interval, {1.5, 8.316666666666668});
}

TEST(BootstrapMean, OfFewOrEqualValuesHasNoInterval) {
  EXPECT_FALSE(bootstrap_mean(each_alone({})).interval);
  EXPECT_FALSE(bootstrap_mean(each_alone({1.0, 2.0, 3.0, 4.0})).interval);
  EXPECT_TRUE(bootstrap_mean(each_alone({1.0, 2.0, 3.0, 4.0, 5.0})).interval);
  EXPECT_FALSE(bootstrap_mean(each_alone({0.1, 0.1, 0.1, 0.1, 0.1, 0.1})).interval);
  EXPECT_EQ(bootstrap_mean(each_alone({0.1, 0.1, 0.1, 0.1, 0.1, 0.1})).mean, 0.1);
}

/// Twelve clusters of one to three values.
const Clusters kClusters{{0.3, 0.5},      {1.9}, {0.7, 0.2, 0.9}, {4.0, 3.1}, {0.1}, {2.2, 2.9},
                         {0.6, 0.4, 1.1}, {1.3}, {5.0, 4.4, 6.1}, {0.8, 0.9}, {1.7}, {0.2, 0.3}};

// From the values as lists of lists, in Python:
//   n = 12; m = mean of all; d = [sum(c) - m * len(c) for c in clusters]; z = 2.200985 * sqrt(12 / 11)
//   300000 times: draw 12 clusters with replacement, take the mean of all their values; BCa with acceleration
//   sum(d^3) / (6 sum(d^2)^1.5)
TEST(BootstrapMean, OfClustersOfSeveralSizesIsTheWidenedBcaIntervalOfAnOracle) {
  const MeanEstimate mean = bootstrap_mean(kClusters);
  EXPECT_EQ(mean.count, 23U);
  EXPECT_EQ(mean.clusters, 12U);
  EXPECT_NEAR(mean.mean, 1.7217391304347829, 1e-12);
  expect_near(mean.interval, {0.8272727272727274, 3.53623423284434});
}

TEST(BootstrapMean, OfClustersIsTheSameInAnyOrderAndItsNegativesTheNegative) {
  const MeanInterval before = *bootstrap_mean(kClusters).interval;
  Clusters turned(kClusters.rbegin(), kClusters.rend());
  EXPECT_NEAR(bootstrap_mean(turned).interval->low, before.low, 1e-12);
  EXPECT_NEAR(bootstrap_mean(turned).interval->high, before.high, 1e-12);
  for (auto& cluster : turned) {
    for (double& value : cluster) value = -value;
  }
  EXPECT_NEAR(bootstrap_mean(turned).interval->low, -before.high, 1e-12);
  EXPECT_NEAR(bootstrap_mean(turned).interval->high, -before.low, 1e-12);
}

TEST(BootstrapMean, OfClustersWithEqualMeansHasNoInterval) {
  EXPECT_FALSE(bootstrap_mean({{0.1, 0.3}, {0.1, 0.3}, {0.1, 0.3}, {0.1, 0.3}, {0.1, 0.3}, {0.1, 0.3}}).interval);
  EXPECT_FALSE(bootstrap_mean({{0.1}, {0.1, 0.1}, {0.1, 0.1, 0.1}, {0.1}, {0.1}, {0.1}}).interval);
  EXPECT_FALSE(bootstrap_mean({{0.1, 0.5}, {0.5, 0.1}, {0.3}, {0.1, 0.3, 0.5}, {0.3}, {0.3}}).interval) << "rounding";
}

TEST(MeanOfSample, IsStudentsOfFewClustersAndTheBootstrapsOfMore) {
  std::vector<double> values{0.1, 0.3, 0.4, 0.9, 1.1, 1.3, 2.0, 2.2, 3.7, 0.2,
                             0.2, 0.5, 0.7, 0.8, 1.0, 1.2, 1.5, 1.9, 2.6};
  EXPECT_EQ(mean_of_sample(each_alone(values)).interval->high, estimate_mean(each_alone(values)).interval->high);
  values.push_back(5.1);
  EXPECT_EQ(mean_of_sample(each_alone(values)).interval->high, bootstrap_mean(each_alone(values)).interval->high);
  EXPECT_FALSE(mean_of_sample(each_alone({0.1, 0.3, 0.4, 0.9})).interval);
  EXPECT_FALSE(mean_of_sample(each_alone({0.1, 0.1, 0.1, 0.1, 0.1, 0.1})).interval);
  EXPECT_FALSE(mean_of_sample({}).interval);
}

TEST(BootstrapMean, OfOneValueThatDiffersStaysWithinTheValues) {
  std::vector<double> values(1000, 0.0);
  values.back() = 1.0;
  const MeanInterval interval = *bootstrap_mean(each_alone(values)).interval;
  EXPECT_GE(interval.low, 0.0);
  EXPECT_GT(interval.high, 0.002);
  EXPECT_LT(interval.high, 0.01);
}

// Ratios of means of pairs. The reference ends come from Python's random.choices() on 300000 samples of these pairs,
// and the acceleration from leaving out one pair at a time (seed 1, z = 2.200985 sqrt(12 / 11)).
const std::vector<double> kAbove{0.9, 1.2, 0.4, 2.2, 0.7, 3.1, 0.8, 1.9, 0.3, 1.4, 5.2, 0.6};
const std::vector<double> kBelow{1.1, 1.0, 0.9, 2.9, 1.6, 3.0, 1.2, 2.8, 0.2, 2.3, 4.1, 1.5};

TEST(BootstrapRatio, OfPairsIsTheWidenedBcaIntervalOfAnOracle) {
  const auto ratio = bootstrap_ratio(kAbove, kBelow);
  ASSERT_TRUE(ratio && ratio->interval);
  EXPECT_EQ(ratio->count, 12U);
  EXPECT_NEAR(ratio->ratio, 18.7 / 22.6, 1e-12);
  expect_near(ratio->interval, {0.6412213740458015, 1.108});
}

TEST(BootstrapRatio, TakesWholePairsSoThatWhatTheyShareIsNoSpread) {
  std::vector<double> above;
  for (const double value : kBelow) above.push_back(0.8 * value);
  const auto same = bootstrap_ratio(above, kBelow);
  ASSERT_TRUE(same);
  EXPECT_NEAR(same->ratio, 0.8, 1e-12);
  EXPECT_FALSE(same->interval) << "pairs of one ratio do not say how far the next may lie";
  above.front() *= 1.001;
  const auto nearly = bootstrap_ratio(above, kBelow);
  ASSERT_TRUE(nearly && nearly->interval);
  EXPECT_LT(width(*nearly->interval), 1e-3);
}

TEST(BootstrapRatio, SaysNothingOfWhatMayBeNegativeOrNothing) {
  EXPECT_FALSE(bootstrap_ratio({}, {}));
  EXPECT_FALSE(bootstrap_ratio({1.0, -1.0}, {1.0, 1.0}));
  EXPECT_FALSE(bootstrap_ratio({1.0, 1.0}, {1.0, -1.0}));
  EXPECT_FALSE(bootstrap_ratio({1.0, 1.0}, {0.0, 0.0}));
  EXPECT_FALSE(bootstrap_ratio({1.0, 2.0, 3.0, 4.0}, {2.0, 2.0, 2.0, 2.0})->interval) << "too few";
  EXPECT_EQ(bootstrap_ratio({0.0, 0.0}, {1.0, 2.0})->ratio, 0.0);
}

TEST(BootstrapRatio, HasNoUpperEndWhereAlmostNothingIsBelow) {
  const auto ratio = bootstrap_ratio({1, 1, 1, 1, 1, 1}, {0, 0, 0, 0, 0, 1});
  ASSERT_TRUE(ratio && ratio->interval);
  EXPECT_EQ(ratio->ratio, 6.0);
  EXPECT_TRUE(std::isinf(ratio->interval->high));
}

}  // namespace
}  // namespace palpate
