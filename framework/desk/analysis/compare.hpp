// SPDX-License-Identifier: MIT
// Groups of a sweep's jobs side by side: each with its mean and spread, every two of them compared on the jobs that
// are equal in all but what makes the groups. Seeds are the units of statistics: all jobs of a seed are drawn together,
// and the means per seed are ranked. analysis/compare_report.hpp shows it.
#pragma once

#include "analysis/bootstrap.hpp"
#include "analysis/column.hpp"
#include "analysis/signed_rank.hpp"
#include "analysis/statistics.hpp"
#include "record/occasion.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// How much of a comparison is computed: the means of the groups, with their intervals, or with all pairs, too.
/// Intervals and pairs are what takes time.
enum class CompareExtent { means, intervals, pairs };

/// What is asked.
struct CompareQuery {
  std::vector<std::string> by;          ///< swept keys; jobs that have the same values of them are a group
  std::string metric;                   ///< a column of results.csv
  const Condition* where = nullptr;     ///< on the columns of results.csv: other jobs are left out; null for none
  std::optional<std::string> baseline;  ///< the group that all others are compared with: "weighted, rbf", or, where the
                                        ///< scene is a key, too, "weighted": that of each scene
  bool ratios = false;                  ///< of the means of each pair, too
  CompareExtent extent = CompareExtent::pairs;
};

struct ComparedGroup {
  std::string name;  ///< its values, in the order of the keys: "weighted, rbf"; "(none)" of a key that its jobs lack
  std::vector<std::string> values;  ///< the same one by one
  StatusCounts counts;
  int never = 0;      ///< jobs that count as they ended, because they never got where they were to be looked at
  MeanEstimate mean;  ///< over the jobs that have a value; clusters: seeds, or jobs where these are the units
  double median = 0.0;
  double low_10 = 0.0;  ///< the values that 10 % and 90 % of the jobs stay below
  double high_90 = 0.0;
};

/// What `first` has more than `second`, over the pairs of jobs in which both have a value.
struct ComparedPair {
  std::size_t first = 0;  ///< indices in Comparison::groups
  std::size_t second = 0;
  /// Pairs that are not complete. Of what the condition leaves out those count of which it keeps one job.
  StatusCounts lost;
  MeanEstimate difference;             ///< count: pairs of jobs; clusters: seeds
  std::optional<RatioEstimate> ratio;  ///< mean of the first over that of the second; if asked for, and it makes sense
  SignedRank test;                     ///< of the means per unit: JobUnits
  std::optional<double> p_holm;        ///< adjusted for all pairs of this comparison; none if there is but one
};

struct Comparison {
  Column metric;
  std::vector<std::string> by;
  bool by_seed = false;              ///< seeds are the units: see JobUnits
  std::vector<std::string> pairing;  ///< the other swept keys, if they vary: they are equal within a pair
  /// Of those keys the ones of which some compared groups have no value in common, so that they have no pairs.
  std::vector<std::string> apart;
  std::vector<ComparedGroup> groups;  ///< sorted by the first key, then the second, each in the order of the sweep
  std::vector<ComparedPair> pairs;    ///< each group with those before it, or with the baseline alone
  /// Of the groups that have one.
  std::vector<double> means() const;
  /// Returns whether some units have several values though seeds are not the units: copies of a run.
  bool has_copies() const;

  std::size_t compared = 0;  ///< groups; those that the condition leaves out whole are in no pair
  bool one_baseline = false;
  bool scenes_apart = false;         ///< the scene is one of the keys: groups of two scenes are in no pair
  bool ratios = false;               ///< asked for
  std::optional<Occasion> occasion;  ///< at which the jobs are looked at; none: as they ended
  int jobs = 0;                      ///< of the sweep
  StatusCounts left_out;             ///< of them, by the condition: what else became of those
};

/// With more groups, of one scene each, only pairs with the first group are compared, unless a baseline is named.
inline constexpr std::size_t kMostGroupsInPairs = 8;

/// Compares the jobs of `sweep`, whose rows of results.csv are `results`. Throws Error, of the command line, for keys
/// that are not swept, a metric that is swept and no result, does not exist, holds no numbers or has no value in any
/// job, a baseline that is no group, and a condition that asks for unknown columns or leaves nothing.
Comparison compare(const Sweep& sweep, const std::vector<Row>& results, const CompareQuery& query);

}  // namespace palpate
