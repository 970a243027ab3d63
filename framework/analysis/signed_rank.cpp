// SPDX-License-Identifier: MIT
#include "analysis/signed_rank.hpp"

#include "analysis/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {
namespace {

struct RankedDifference {
  double size = 0.0;
  bool higher = false;
  double rounding = 0.0;         ///< bound of the rounding error of `size`
  std::size_t doubled_rank = 0;  ///< twice the rank, which is a whole number even for ties; ties have their mean rank
};

/// Sets the ranks of differences, which must be sorted by size. Returns the sum of t^3 - t over all sets of equal
/// sizes, where t is the number of elements of the set.
double rank(std::vector<RankedDifference>& sorted) {
  double ties = 0.0;
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin + 1;
    while (end < sorted.size() &&
           sorted[end].size - sorted[end - 1].size <= std::max(sorted[end].rounding, sorted[end - 1].rounding)) {
      ++end;
    }
    for (std::size_t i = begin; i < end; ++i) sorted[i].doubled_rank = begin + 1 + end;
    const auto t = static_cast<double>(end - begin);
    ties += t * t * t - t;
    begin = end;
  }
  return ties;
}

/// Returns the probability that a rank sum is at most `doubled_sum` / 2 if every sign is random. Computes the
/// distribution of the rank sum by adding one rank at a time.
double share_at_most(const std::vector<RankedDifference>& ranked, std::size_t doubled_sum) {
  std::vector<double> share(doubled_sum + 1, 0.0);
  share[0] = 1.0;
  for (const RankedDifference& one : ranked) {
    for (std::size_t sum = doubled_sum + 1; sum-- > 0;)
      share[sum] = 0.5 * (share[sum] + (sum >= one.doubled_rank ? share[sum - one.doubled_rank] : 0.0));
  }
  return std::accumulate(share.begin(), share.end(), 0.0);
}

}  // namespace

SignedRank signed_rank_test(const std::vector<double>& first, const std::vector<double>& second) {
  SignedRank out;
  std::vector<RankedDifference> ranked;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double difference = first[i] - second[i];
    const double rounding = kRounding * std::max(std::abs(first[i]), std::abs(second[i]));
    if (std::abs(difference) <= rounding) {
      ++out.equal;
      continue;
    }
    ++(difference > 0.0 ? out.higher : out.lower);
    ranked.push_back({std::abs(difference), difference > 0.0, rounding, 0});
  }
  if (!first.empty()) out.p = 1.0;
  if (ranked.empty()) return out;
  std::sort(ranked.begin(), ranked.end(),
            [](const RankedDifference& a, const RankedDifference& b) { return a.size < b.size; });
  const double ties = rank(ranked);
  std::size_t higher = 0;
  std::size_t lower = 0;
  for (const RankedDifference& one : ranked) (one.higher ? higher : lower) += one.doubled_rank;
  out.rank_sum_higher = static_cast<double>(higher) / 2.0;
  out.rank_sum_lower = static_cast<double>(lower) / 2.0;
  const double sum = out.rank_sum_higher + out.rank_sum_lower;
  out.effect = (out.rank_sum_higher - out.rank_sum_lower) / sum;
  out.exact = ranked.size() <= kExactSignedRanks;
  if (out.exact) {
    // The two tails of the symmetric distribution are equal. Near the middle they overlap, so p is limited to 1.
    out.p = std::min(1.0, 2.0 * share_at_most(ranked, std::min(higher, lower)));
    return out;
  }
  const auto n = static_cast<double>(ranked.size());
  const double variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
  const double z = (out.rank_sum_higher - sum / 2.0) / std::sqrt(variance);
  out.p = std::erfc(std::abs(z) / std::sqrt(2.0));
  return out;
}

std::vector<double> holm_adjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

}  // namespace palpate
