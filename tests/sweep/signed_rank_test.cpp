// SPDX-License-Identifier: MIT
// The signed-rank test, compared with printed tables, with scipy, and with an enumeration of all sign patterns.
#include "analysis/signed_rank.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {
namespace {

SignedRank against_zero(const std::vector<double>& differences) {
  return signed_rank_test(differences, std::vector<double>(differences.size(), 0.0));
}

TEST(SignedRank, OfTheDepressionScalesIsThatOfTheTextbook) {
  // Hollander and Wolfe 1973, page 29: T+ = 40, one-sided p = 0.020, doubled here: 20 of the 512 patterns.
  const SignedRank test = signed_rank_test({1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30},
                                           {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29});
  EXPECT_EQ(test.rank_sum_higher, 40.0);
  EXPECT_EQ(test.rank_sum_lower, 5.0);
  EXPECT_DOUBLE_EQ(*test.p, 20.0 / 512.0);
  EXPECT_DOUBLE_EQ(*test.effect, 35.0 / 45.0);
}

// python3 -c "from scipy.stats import wilcoxon as w; print(w([i * 37 % 101 - 40 for i in range(1, 401)],
//   mode='approx', correction=False), w([i * 7919 % 1009 - 480.5 for i in range(1, 501)], mode='approx',
//   correction=False))"
TEST(SignedRank, OfManyPairsIsScipysNormalApproximationWithTiesAndWithout) {
  std::vector<double> tied;
  for (int i = 1; i <= 400; ++i) tied.push_back(i * 37 % 101 - 40);
  const SignedRank test = against_zero(tied);
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.equal, 4U);
  EXPECT_EQ(test.rank_sum_lower, 25088.0);
  EXPECT_NEAR(*test.p / 4.4541068026624374e-10, 1.0, 1e-9);

  std::vector<double> untied;
  for (int i = 1; i <= 500; ++i) untied.push_back(i * 7919 % 1009 - 480.5);
  EXPECT_EQ(std::min(against_zero(untied).rank_sum_lower, against_zero(untied).rank_sum_higher), 56927.0);
  EXPECT_NEAR(*against_zero(untied).p, 0.0779310714344527, 1e-12);
}

/// Returns p by enumeration of all 2^n sign patterns, with ranks from their definition.
double p_by_enumeration(const std::vector<double>& differences) {
  std::vector<double> sizes;
  for (const double difference : differences) {
    if (difference != 0.0) sizes.push_back(std::abs(difference));
  }
  std::vector<double> ranks;
  for (const double size : sizes) {
    const auto smaller = std::count_if(sizes.begin(), sizes.end(), [&](double other) { return other < size; });
    const auto equal = std::count(sizes.begin(), sizes.end(), size);
    ranks.push_back(static_cast<double>(smaller) + static_cast<double>(equal + 1) / 2.0);
  }
  const double middle = std::accumulate(ranks.begin(), ranks.end(), 0.0) / 2.0;
  double observed = 0.0;
  std::size_t next = 0;
  for (const double difference : differences) {
    if (difference == 0.0) continue;
    if (difference > 0.0) observed += ranks[next];
    ++next;
  }
  const std::size_t patterns = std::size_t{1} << ranks.size();
  std::size_t as_far = 0;
  for (std::size_t pattern = 0; pattern < patterns; ++pattern) {
    double sum = 0.0;
    for (std::size_t i = 0; i < ranks.size(); ++i) sum += (pattern >> i & 1U) != 0 ? ranks[i] : 0.0;
    as_far += std::abs(sum - middle) >= std::abs(observed - middle) ? 1 : 0;
  }
  return static_cast<double>(as_far) / static_cast<double>(patterns);
}

TEST(SignedRank, IsTheCountOfAllSignsInHundredsOfCasesWithTiesAndZeros) {
  for (std::uint64_t i = 0; i < 400; ++i) {
    Random random(i, "signed ranks");
    const std::uint64_t values = i % 3 == 0 ? 1000 : i % 3 == 1 ? 7 : 3;
    std::vector<double> differences(random.index(13));
    for (double& one : differences) one = static_cast<double>(random.index(values)) - static_cast<double>(values / 3);
    const SignedRank test = against_zero(differences);
    if (differences.empty()) {
      EXPECT_FALSE(test.p);
    } else {
      EXPECT_NEAR(*test.p, p_by_enumeration(differences), 1e-12) << "case " << i;
    }
    EXPECT_EQ(test.higher + test.equal + test.lower, differences.size());
  }
}

TEST(SignedRank, DoesNotChangeWithShiftScaleAndOrder) {
  const std::vector<double> a{0.3, 0.1, 0.4, 0.1, 0.5, 0.9, 0.2, 0.6};
  const std::vector<double> b{0.2, 0.7, 0.1, 0.2, 0.5, 0.8, 0.1, 0.8};
  const SignedRank before = signed_rank_test(a, b);
  EXPECT_EQ(before.equal, 1U);
  std::vector<double> far_a(a.rbegin(), a.rend());
  std::vector<double> far_b(b.rbegin(), b.rend());
  // 0.3 - 0.2 and 0.9 - 0.8 are different doubles, also after a shift, but rounding must not decide ties.
  for (auto* values : {&far_a, &far_b}) {
    for (double& value : *values) value = 7.0 + 0.01 * value;
  }
  const SignedRank after = signed_rank_test(far_a, far_b);
  EXPECT_EQ(*before.p, *after.p);
  EXPECT_EQ(*before.effect, *after.effect);
  EXPECT_EQ(before.equal, after.equal);
}

TEST(SignedRank, OfEqualPairsIsOneWithoutAnEffect) {
  const SignedRank test = signed_rank_test({1, 2, 3}, {1, 2, 3});
  EXPECT_EQ(test.equal, 3U);
  EXPECT_EQ(*test.p, 1.0);
  EXPECT_FALSE(test.effect);
  EXPECT_FALSE(signed_rank_test({}, {}).p);
}

TEST(SignedRank, OfPairsThatAllPointOneWayIsTwoOfAllPatterns) {
  EXPECT_DOUBLE_EQ(*against_zero({1, 1, 1, 1, 1, 1}).p, 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(*against_zero({1, 1, 1, 1, 1, 1}).effect, 1.0);
  EXPECT_DOUBLE_EQ(*against_zero({-2}).p, 1.0);
  EXPECT_DOUBLE_EQ(*against_zero({-2}).effect, -1.0);
  EXPECT_NEAR(*against_zero(std::vector<double>(kExactSignedRanks, 2.0)).p / std::pow(2.0, -299.0), 1.0, 1e-12);
}

TEST(Holm, IsWhatOneComputesByHand) {
  // Sorted: 0.005, 0.01, 0.03, 0.04 times 4, 3, 2, 1; no result is below the one before.
  const std::vector<double> adjusted = holm_adjusted({0.01, 0.04, 0.03, 0.005});
  const double expected[] = {0.03, 0.06, 0.06, 0.02};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(adjusted[i], expected[i], 1e-15) << i;
}

TEST(Holm, StaysWithinOneAndLeavesASinglePAlone) {
  EXPECT_EQ(holm_adjusted({0.7, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_EQ(holm_adjusted({0.03}), (std::vector<double>{0.03}));
  EXPECT_TRUE(holm_adjusted({}).empty());
}

}  // namespace
}  // namespace palpate
