// SPDX-License-Identifier: MIT
// Wilcoxon's signed-rank test of paired values, with its effect size, and Holm's adjustment for several tests.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// Largest number of nonzero differences for which the distribution of the rank sum is computed exactly.
inline constexpr std::size_t kExactSignedRanks = 300;

/// Result of the test of the differences first - second.
struct SignedRank {
  std::size_t higher = 0;  ///< number of pairs whose first value is larger
  std::size_t equal = 0;   ///< number of pairs with equal values; ranks and p ignore these pairs
  std::size_t lower = 0;
  /// Sum of the ranks of the absolute differences, over the pairs in `higher`. Ties have their mean rank.
  double rank_sum_higher = 0.0;
  double rank_sum_lower = 0.0;
  std::optional<double> p;  ///< two-sided p; 1 if all pairs are equal, nullopt if there are no pairs
  bool exact = true;
  /// Matched-pairs rank-biserial correlation (Kerby 2014, The simple difference formula): the difference of the two
  /// rank sums divided by their sum. It is 1 if the first value of a pair is never lower, -1 if the first value is
  /// never higher, and nullopt if all pairs are equal.
  std::optional<double> effect;
};

/// Tests finite values that are paired by index. Both vectors must have the same length. Values that differ by at most
/// kRounding times the larger absolute value count as equal. Up to kExactSignedRanks differences, p is computed exactly
/// from the distribution of the rank sum under random signs, even if there are ties. With more differences, p is the
/// normal approximation, with the variance for ties and without continuity correction (Hollander, Wolfe and Chicken
/// 2014, Nonparametric statistical methods, section 3.1).
SignedRank signed_rank_test(const std::vector<double>& first, const std::vector<double>& second);

/// Returns the p values of several tests, adjusted by Holm's method, in the given order. If all hypotheses with an
/// adjusted p below `a` are rejected, the probability of rejecting any true hypothesis is at most `a` (Holm 1979, A
/// simple sequentially rejective multiple test procedure).
std::vector<double> holm_adjusted(const std::vector<double>& p);

}  // namespace palpate
