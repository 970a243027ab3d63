// SPDX-License-Identifier: MIT
// Whether paired values differ, without an assumption on their distribution: Wilcoxon's signed-rank test, its effect
// size, and what p becomes when several pairs are tested.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// Up to so many differences that are not 0 the distribution of the rank sum is counted out.
inline constexpr std::size_t kExactSignedRanks = 300;

/// What the test says of first - second.
struct SignedRank {
  std::size_t higher = 0;  ///< pairs of which the first value is the larger
  std::size_t equal = 0;   ///< they take no part in ranks and p
  std::size_t lower = 0;
  double rank_sum_higher = 0.0;  ///< of the absolute differences of the higher pairs; equal ones share their mean rank
  double rank_sum_lower = 0.0;
  std::optional<double> p;  ///< two-sided; 1 if all pairs are equal, none of no pairs
  bool exact = true;
  /// Matched-pairs rank-biserial correlation (Kerby 2014, The simple difference formula): the difference of the two
  /// rank sums over their sum, 1 if the first is never lower, -1 if never higher. None if all pairs are equal.
  std::optional<double> effect;
};

/// Of as many finite values in each, paired by their index. What differs by less than kRounding of the values is equal:
/// rounding decides no rank. Exact with ties and without, by the distribution of the rank sum under random signs of
/// the differences; beyond kExactSignedRanks the normal approximation with the variance that ties leave (Hollander,
/// Wolfe and Chicken 2014, Nonparametric statistical methods, section 3.1), without continuity correction.
SignedRank signed_rank_test(const std::vector<double>& first, const std::vector<double>& second);

/// The p of several tests adjusted such that, whichever hypotheses are true, one of those is rejected at level a with
/// probability at most a (Holm 1979, A simple sequentially rejective multiple test procedure). In the order given.
std::vector<double> holm_adjusted(const std::vector<double>& p);

}  // namespace palpate
