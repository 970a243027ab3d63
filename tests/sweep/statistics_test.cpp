// SPDX-License-Identifier: MIT
#include "analysis/statistics.hpp"

#include "support/clusters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

using test::each_alone;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(StudentFactor, IsThatOfThePrintedTables) {
  // Two-sided 95 %, three decimals, from textbook tables.
  const std::pair<std::size_t, double> table[] = {{1, 12.706},   {2, 4.303},      {3, 3.182},  {4, 2.776},
                                                  {9, 2.262},    {19, 2.093},     {29, 2.045}, {120, 1.980},
                                                  {1000, 1.962}, {1000000, 1.960}};
  for (const auto& [degrees, factor] : table) EXPECT_NEAR(student_factor(degrees), factor, 5e-4) << degrees;
}

TEST(MeanEstimate, OfFourNumbersIsWhatOneComputesByHand) {
  // The squared differences from 3 add up to 4 + 1 + 0 + 9 = 14; the standard error is sqrt(14 / 3 / 4).
  const MeanEstimate estimate = estimate_mean(each_alone({1.0, 2.0, 3.0, 6.0}));
  EXPECT_EQ(estimate.count, 4U);
  EXPECT_DOUBLE_EQ(estimate.mean, 3.0);
  ASSERT_TRUE(estimate.interval);
  EXPECT_NEAR(estimate.interval->high, 3.0 + 3.182446305 * std::sqrt(14.0 / 12.0), 1e-8);
  EXPECT_NEAR(estimate.interval->low, 3.0 - 3.182446305 * std::sqrt(14.0 / 12.0), 1e-8);
}

TEST(MeanEstimate, OfEqualValuesHasNoIntervalHoweverMany) {
  for (const std::size_t count : {2U, 3U, 500U}) {
    const MeanEstimate estimate = estimate_mean(each_alone(std::vector<double>(count, 0.1)));
    EXPECT_EQ(estimate.mean, 0.1) << "three times 0.1 / 3 is not 0.1";
    EXPECT_FALSE(estimate.interval) << count;
  }
}

TEST(MeanEstimate, OfValuesThatAreEqualButForRoundingHasNoInterval) {
  EXPECT_FALSE(estimate_mean(each_alone({0.3, 0.1 + 0.2, 0.3})).interval);
  EXPECT_TRUE(estimate_mean(each_alone({0.3, 0.3 + 1e-11, 0.3})).interval);
  // Differences of numbers near 1000, equal except for rounding.
  const Clusters differences = each_alone({1000.1 - 1000.0, 1000.2 - 1000.1, 1000.3 - 1000.2});
  EXPECT_TRUE(estimate_mean(differences).interval);
  EXPECT_FALSE(estimate_mean(differences, 1000.3).interval);
}

TEST(MeanEstimate, OfLargeNumbersDoesNotOverflow) {
  EXPECT_NEAR(estimate_mean(each_alone({1.5e308, 1.6e308, 1.7e308})).mean / 1.6e308, 1.0, 1e-12);
}

TEST(MeanEstimate, OfCloseNumbersFarFromZeroKeepsItsSpread) {
  const MeanEstimate estimate = estimate_mean(each_alone({1e9 - 1.0, 1e9, 1e9 + 1.0}));
  EXPECT_NEAR(estimate.interval->high - estimate.mean, 4.302652730 / std::sqrt(3.0), 1e-6);
}

TEST(NormalQuantile, IsThatOfThePrintedTablesAndFarOutOfScipys) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
  // python3 -c "from scipy.stats import norm; print(norm.ppf(1e-10))"
  EXPECT_NEAR(normal_quantile(1e-10), -6.361340902404056, 1e-10);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_EQ(quantile({1.0, 2.0, 3.0}, 0.5), 2.0);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, 4.0}, 0.5), 2.5);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, 4.0}, 0.0), 1.0);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, 4.0}, 1.0), 4.0);
  EXPECT_NEAR(quantile({0.0, 10.0}, 0.9), 9.0, 1e-12);
  EXPECT_EQ(quantile({5.0}, 0.9), 5.0);
}

TEST(Quantile, IsFiniteWhereNoInfiniteValueHasAPartInIt) {
  EXPECT_EQ(quantile({1.0, 2.0, kInfinity}, 0.5), 2.0);
  EXPECT_EQ(quantile({1.0, 2.0, 3.0, kInfinity}, 0.9), kInfinity);
  EXPECT_EQ(quantile({-kInfinity, 1.0, 2.0}, 0.5), 1.0);
  EXPECT_EQ(quantile({-kInfinity, 1.0}, 0.5), -kInfinity);
  EXPECT_EQ(quantile({kInfinity, kInfinity}, 0.5), kInfinity);
}

// By hand: clusters {1, 3}, {2}, {5, 6, 7}; mean 24 / 6 = 4; sums less the mean's share -4, -2, 6;
// variance 3 / 2 (16 + 4 + 36) / 6^2 = 7 / 3; t of two degrees of freedom 4.30265.
TEST(EstimateMean, OfClustersHasTheStandardErrorOfARatioEstimator) {
  const MeanEstimate estimate = estimate_mean({{1.0, 3.0}, {2.0}, {5.0, 6.0, 7.0}});
  EXPECT_EQ(estimate.count, 6U);
  EXPECT_EQ(estimate.clusters, 3U);
  EXPECT_NEAR(estimate.mean, 4.0, 1e-12);
  EXPECT_NEAR(estimate.interval->high - 4.0, 4.302652729749464 * std::sqrt(7.0 / 3.0), 1e-9);
}

}  // namespace
}  // namespace palpate
