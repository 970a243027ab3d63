// SPDX-License-Identifier: MIT
// Comparison of groups of a sweep's jobs: mean and spread per group, and paired differences between groups. A pair
// consists of two jobs that have equal values of every other swept key. If seeds are swept, they are the units of
// statistics: the bootstrap resamples all jobs of a seed together, and tests rank the means per seed. Otherwise jobs
// are the units (StatisticalUnits). The output is in analysis/compare_report.hpp.
#pragma once

#include "analysis/bootstrap.hpp"
#include "analysis/column.hpp"
#include "analysis/signed_rank.hpp"
#include "analysis/statistics.hpp"
#include "record/evaluation_point.hpp"
#include "sweep/sweep.hpp"
#include "sweep/where_condition.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Extent of a comparison: means of the groups, means with intervals, or means with intervals and all pairs. Intervals
/// and pairs take most of the computing time.
enum class CompareExtent { means, intervals, pairs };

/// Arguments of compare().
struct CompareQuery {
  std::vector<std::string> by;  ///< swept keys; jobs with equal values of these keys form a group
  std::string metric;           ///< column of results.csv
  /// condition on columns of results.csv, or null for none; other jobs are left out
  const WhereCondition* where = nullptr;
  /// Name of the group with which all others are compared: "weighted, rbf". If the scene is one of the keys, "weighted"
  /// names the group `weighted` of each scene.
  std::optional<std::string> baseline;
  bool ratios = false;  ///< whether to compute, for every two compared groups, the ratio of their means
  CompareExtent extent = CompareExtent::pairs;
};

struct ComparedGroup {
  std::string name;  ///< values in the order of the keys: "weighted, rbf"; "(none)" for a key that the jobs lack
  std::vector<std::string> values;  ///< the values in `name`, as a list
  StatusCounts counts;
  /// number of jobs that never reached the checkpoint Comparison::occasion; such jobs count with their final values
  int never = 0;
  MeanEstimate mean;  ///< mean over the jobs with a value; the clusters are the units of StatisticalUnits
  double median = 0.0;
  double low_10 = 0.0;  ///< `low_10` and `high_90` are the 10 % and 90 % quantiles over the jobs
  double high_90 = 0.0;
};

/// Differences `first` minus `second`, over the pairs in which both jobs have a value.
struct ComparedPair {
  std::size_t first = 0;  ///< `first` and `second` are indices in Comparison::groups
  std::size_t second = 0;
  /// Pairs of jobs without two values, by status. A pair counts as left out if the condition excludes one of its jobs
  /// and keeps the other.
  StatusCounts lost;
  /// mean difference; `count` is the number of pairs, and clusters are pairs with equal units (StatisticalUnits)
  MeanEstimate difference;
  /// spread of the differences per unit; nullopt for fewer than two units and for equal differences
  std::optional<UnitSpread> spread;
  /// Mean of the first group divided by the mean of the second group; nullopt if the ratio was not requested or is not
  /// defined.
  std::optional<RatioEstimate> ratio;
  SignedRank test;  ///< test of the means per unit (StatisticalUnits)
  /// p of the test, adjusted for all pairs of this comparison; nullopt for a single pair
  std::optional<double> p_holm;
};

struct Comparison {
  Column metric;
  std::vector<std::string> by;
  bool by_seed = false;  ///< whether seeds are the units (StatisticalUnits)
  /// swept keys that vary and are not in `by`; the two jobs of a pair have equal values of these keys
  std::vector<std::string> pairing;
  /// Keys of `pairing` for which some compared groups have no value in common. Such groups have no pairs.
  std::vector<std::string> apart;
  std::vector<ComparedGroup> groups;  ///< sorted by their values of `by`, which are in the order of the sweep
  std::vector<ComparedPair> pairs;    ///< pairs of each group with each earlier group, or only with the baseline
  /// Returns the means of all groups with values.
  std::vector<double> means() const;
  /// Returns whether jobs are the units and some jobs of a group are copies of one run (StatisticalUnits).
  bool has_copies() const;

  /// Number of groups with jobs that satisfy the condition. Other groups have no pairs.
  std::size_t compared = 0;
  bool one_baseline = false;
  /// whether the groups belong to several scenes and `by` also has other keys; groups of different scenes are then not
  /// paired
  bool scenes_apart = false;
  bool ratios = false;  ///< whether ratios were requested
  /// checkpoint at which jobs are compared; nullopt if jobs are compared at their ends
  std::optional<Checkpoint> occasion;
  int jobs = 0;                     ///< number of jobs of the sweep
  std::optional<std::string> plan;  ///< hash of the plan that the sweep's config has: see mark_planned()
  bool planned = false;             ///< whether this comparison is the planned one
  /// smallest difference that matters (SI units), if this comparison is planned and decides
  std::optional<double> difference;
  /// jobs that the condition leaves out, by the status that they would have without the condition
  StatusCounts left_out;
};

/// Largest number of groups per scene for which all pairs are compared. With more groups, each group is compared only
/// with the baseline, by default the first group.
inline constexpr std::size_t kMostGroupsInPairs = 8;

/// Compares the jobs of `sweep`. `results` are the rows of results.csv. Throws Error with the place "command line" for
/// keys that are not swept, an unusable metric, an unknown baseline, and a condition with unknown columns or without
/// matching jobs. A metric is unusable if it does not exist, is not a result, holds no numbers, or has no value in any
/// job.
Comparison compare(const Sweep& sweep, const std::vector<Row>& results, const CompareQuery& query);

/// Throws Error with the place "command line" unless the groups of the sweep include `baseline`, as CompareQuery has
/// it.
void check_baseline(const Sweep& sweep, const std::vector<std::string>& by, const std::string& baseline);

}  // namespace palpate
