// SPDX-License-Identifier: MIT
// Intervals of the bootstrap against scipy's, against Student's where that is right, and against what they promise.
#include "analysis/bootstrap.hpp"
#include "support/sanitizers.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate {
namespace {

double width(const MeanInterval& interval) { return interval.high - interval.low; }

/// Ends scatter by about 1 % of the width from stream to stream; three times that, and a little for scipy's.
constexpr double kScatter = 0.035;

void expect_near(const std::optional<MeanInterval>& found, const MeanInterval& oracle) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->low, oracle.low, kScatter * width(oracle));
  EXPECT_NEAR(found->high, oracle.high, kScatter * width(oracle));
}

/// 200 numbers between 0 and 1, most of them small.
std::vector<double> skewed_values() {
  std::vector<double> values;
  for (int i = 1; i <= 200; ++i) values.push_back(std::pow((i * i * 7919 % 1009) / 1009.0, 3));
  return values;
}

// Both intervals come from, with the values as x:
//   n = len(x); z = stats.t.ppf(.975, n - 1) * np.sqrt(n / (n - 1)); c = 1 - 2 * stats.norm.sf(z)
//   stats.bootstrap((x,), np.mean, confidence_level=c, method='BCa', n_resamples=400000, random_state=1)
TEST(BootstrapMean, OfFewSkewedValuesIsTheWidenedBcaIntervalOfScipy) {
  const MeanEstimate mean = bootstrap_mean(each_alone({0.1, 0.3, 0.4, 0.9, 1.1, 1.3, 2.0, 2.2, 3.7, 5.1, 7.9, 16.0}));
  EXPECT_NEAR(mean.mean, 41.0 / 12.0, 1e-12);
  EXPECT_EQ(mean.count, 12U);
  expect_near(mean.interval, {1.5, 8.316666666666668});
}

TEST(BootstrapMean, OfManySkewedValuesIsTheWidenedBcaIntervalOfScipy) {
  expect_near(bootstrap_mean(each_alone(skewed_values())).interval, {0.1890972855115677, 0.264400389511537});
}

TEST(BootstrapMean, OfNormalValuesIsStudentsInterval) {
  std::vector<double> values;
  for (int i = 1; i < 400; ++i) values.push_back(5.0 + 2.0 * normal_quantile(i / 400.0));
  expect_near(bootstrap_mean(each_alone(values)).interval, *estimate_mean(each_alone(values)).interval);
}

/// Whether as many samples of `count` values have 1 in their interval as `share` says, within three standard
/// deviations; `draw` has the mean 1.
template <class Draw>
void expect_covered(double share, std::size_t count, const Draw& draw) {
  const int samples = test::brief() ? 100 : 300;
  int hits = 0;
  for (int sample = 0; sample < samples; ++sample) {
    Random random(static_cast<std::uint64_t>(sample), "coverage");
    std::vector<double> values(count);
    for (double& value : values) value = draw(random);
    const auto interval = bootstrap_mean(each_alone(values)).interval;
    hits += interval && interval->low <= 1.0 && 1.0 <= interval->high ? 1 : 0;
  }
  EXPECT_NEAR(hits, share * samples, 3.0 * std::sqrt(share * (1.0 - share) * samples));
}

TEST(BootstrapMean, CoversTheMeanOfTenNormalValuesInNineteenOfTwentyCases) {
  expect_covered(0.95, 10, [](Random& random) { return 1.0 + normal_quantile(random.uniform() + 0x1.0p-54); });
}

TEST(BootstrapMean, CoversTheMeanOfTwentySkewedValuesNearlyAsOften) {
  expect_covered(0.935, 20, [](Random& random) { return -std::log1p(-random.uniform()); });
}

TEST(BootstrapMean, LeansWithTheValues) {
  const MeanEstimate mean = bootstrap_mean(each_alone({0, 0, 0, 0, 0, 0, 1, 1, 2, 9}));
  ASSERT_TRUE(mean.interval);
  EXPECT_GT(mean.interval->high - mean.mean, 1.3 * (mean.mean - mean.interval->low));
  EXPECT_GE(mean.interval->low, 0.0) << "what was drawn from the values stays within them";
}

TEST(BootstrapMean, DoesNotDependOnTheOrderOfTheValues) {
  std::vector<double> values = skewed_values();
  const MeanInterval before = *bootstrap_mean(each_alone(values)).interval;
  std::reverse(values.begin(), values.end());
  std::rotate(values.begin(), values.begin() + 37, values.end());
  // The mean is a sum, whose rounding knows the order.
  EXPECT_NEAR(bootstrap_mean(each_alone(values)).interval->low, before.low, 1e-14);
  EXPECT_NEAR(bootstrap_mean(each_alone(values)).interval->high, before.high, 1e-14);
}

TEST(BootstrapMean, OfTheNegativesIsTheNegativeInterval) {
  std::vector<double> values = skewed_values();
  const MeanInterval before = *bootstrap_mean(each_alone(values)).interval;
  for (double& value : values) value = -value;
  const MeanInterval after = *bootstrap_mean(each_alone(values)).interval;
  EXPECT_EQ(after.low, -before.high);
  EXPECT_EQ(after.high, -before.low);
}

TEST(BootstrapMean, MovesAndStretchesWithTheValues) {
  std::vector<double> values = skewed_values();
  const MeanInterval before = *bootstrap_mean(each_alone(values)).interval;
  for (double& value : values) value = 100.0 + 1000.0 * value;
  const MeanInterval after = *bootstrap_mean(each_alone(values)).interval;
  EXPECT_NEAR(after.low, 100.0 + 1000.0 * before.low, 1e-9);
  EXPECT_NEAR(after.high, 100.0 + 1000.0 * before.high, 1e-9);
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

TEST(BootstrapMean, OfClustersThatRepeatTheirValuesIsThatOfTheValues) {
  const std::vector<double> values{0.1, 0.3, 0.4, 0.9, 1.1, 1.3, 2.0, 2.2, 3.7, 5.1, 7.9, 16.0};
  const MeanInterval once = *bootstrap_mean(each_alone(values)).interval;
  Clusters thrice;
  for (const double value : values) thrice.push_back({value, value, value});
  const MeanEstimate mean = bootstrap_mean(thrice);
  EXPECT_EQ(mean.count, 36U);
  EXPECT_NEAR(mean.interval->low, once.low, 1e-12);
  EXPECT_NEAR(mean.interval->high, once.high, 1e-12);
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

// Of pairs: the ratio of the means. Both ends come from Python's own random.choices() on 300000 samples of
// these pairs, the acceleration by leaving out one pair at a time (seed 1, z = 2.200985 sqrt(12 / 11)).
const std::vector<double> kAbove{0.9, 1.2, 0.4, 2.2, 0.7, 3.1, 0.8, 1.9, 0.3, 1.4, 5.2, 0.6};
const std::vector<double> kBelow{1.1, 1.0, 0.9, 2.9, 1.6, 3.0, 1.2, 2.8, 0.2, 2.3, 4.1, 1.5};

TEST(BootstrapRatio, OfPairsIsTheWidenedBcaIntervalOfAnOracle) {
  const auto ratio = bootstrap_ratio(kAbove, kBelow);
  ASSERT_TRUE(ratio && ratio->interval);
  EXPECT_EQ(ratio->count, 12U);
  EXPECT_NEAR(ratio->ratio, 18.7 / 22.6, 1e-12);
  expect_near(ratio->interval, {0.6412213740458015, 1.108});
}

TEST(BootstrapRatio, ToOnesIsTheIntervalOfTheMean) {
  const std::vector<double> values = skewed_values();
  const auto ratio = bootstrap_ratio(values, std::vector<double>(values.size(), 1.0));
  const MeanEstimate mean = bootstrap_mean(each_alone(values));
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(ratio->ratio, mean.mean, 1e-12);
  expect_near(ratio->interval, *mean.interval);
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

TEST(BootstrapRatio, IsTheSameInAnyOrderAndAnyUnit) {
  const auto before = bootstrap_ratio(kAbove, kBelow);
  const auto turned = bootstrap_ratio({kAbove.rbegin(), kAbove.rend()}, {kBelow.rbegin(), kBelow.rend()});
  EXPECT_EQ(before->interval->low, turned->interval->low);
  EXPECT_EQ(before->interval->high, turned->interval->high);
  std::vector<double> above = kAbove;
  std::vector<double> below = kBelow;
  for (double& value : above) value *= 1e-3;
  for (double& value : below) value *= 1e-3;
  EXPECT_NEAR(bootstrap_ratio(above, below)->interval->high, before->interval->high, 1e-9);
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
