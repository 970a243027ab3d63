// SPDX-License-Identifier: MIT
// Comparison of groups of a sweep's jobs: mean and spread per group, and paired differences between groups. A pair is
// two jobs that are equal in every other swept key. Seeds are the units of statistics: all jobs of a seed are resampled
// together, and means per seed are ranked. For output see analysis/compare_report.hpp.
#pragma once

#include "analysis/bootstrap.hpp"
#include "analysis/column.hpp"
#include "analysis/signed_rank.hpp"
#include "analysis/statistics.hpp"
#include "record/checkpoint.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Extent of a comparison: means of the groups, means with intervals, or both with all pairs. Intervals and pairs take
/// most of the time.
enum class CompareExtent { means, intervals, pairs };

/// Arguments of compare().
struct CompareQuery {
  std::vector<std::string> by;       ///< swept keys; jobs with equal values of these keys form a group
  std::string metric;                ///< column of results.csv
  const Condition* where = nullptr;  ///< condition on columns of results.csv; jobs that do not satisfy it are left out;
                                     ///< null for no condition
  std::optional<std::string> baseline;  ///< name of the group that all others are compared with: "weighted, rbf". If
                                        ///< the scene is one of the keys, "weighted" names that group of each scene.
  bool ratios = false;                  ///< whether to compute the ratio of the means of each pair
  CompareExtent extent = CompareExtent::pairs;
};

struct ComparedGroup {
  std::string name;  ///< values in the order of the keys: "weighted, rbf"; "(none)" for a key that the jobs lack
  std::vector<std::string> values;  ///< the same values one by one
  StatusCounts counts;
  int never = 0;      ///< jobs that never reached the goal of the occasion and count with their final values
  MeanEstimate mean;  ///< over the jobs with a value; clusters are seeds, or jobs if jobs are the units
  double median = 0.0;
  double low_10 = 0.0;  ///< 10 % and 90 % quantiles over the jobs
  double high_90 = 0.0;
};

/// Differences `first` minus `second` over the pairs of jobs that both have a value.
struct ComparedPair {
  std::size_t first = 0;  ///< indices in Comparison::groups
  std::size_t second = 0;
  /// Incomplete pairs. A pair counts as left out if the condition keeps one of its jobs.
  StatusCounts lost;
  MeanEstimate difference;             ///< count: pairs of jobs; clusters: seeds
  std::optional<RatioEstimate> ratio;  ///< mean of the first divided by mean of the second; nullopt unless requested
                                       ///< and defined
  SignedRank test;                     ///< of the means per unit (JobUnits)
  std::optional<double> p_holm;        ///< p adjusted for all pairs of this comparison; nullopt for a single pair
};

struct Comparison {
  Column metric;
  std::vector<std::string> by;
  bool by_seed = false;              ///< whether seeds are the units (JobUnits)
  std::vector<std::string> pairing;  ///< the other swept keys that vary; both jobs of a pair have equal values of them
  /// Keys of `pairing` for which some compared groups have no value in common, and so no pairs.
  std::vector<std::string> apart;
  std::vector<ComparedGroup> groups;  ///< sorted by the first key, then the second; values in the order of the sweep
  std::vector<ComparedPair> pairs;    ///< each group with the groups before it, or with the baseline alone
  /// Returns the means of the groups that have one.
  std::vector<double> means() const;
  /// Returns whether some units have several values although seeds are not the units: copies of a run.
  bool has_copies() const;

  std::size_t compared = 0;  ///< number of groups with jobs; groups that the condition leaves out entirely have no
                             ///< pairs
  bool one_baseline = false;
  bool scenes_apart = false;  ///< whether the scene is one of the keys; groups of different scenes form no pair
  bool ratios = false;        ///< whether ratios were requested
  std::optional<Checkpoint> occasion;  ///< the point of a run at which the jobs are compared; nullopt: their ends
  int jobs = 0;                        ///< number of jobs of the sweep
  StatusCounts left_out;               ///< jobs that the condition leaves out, by the status that they would have
};

/// Number of groups per scene up to which all pairs are compared. With more groups, only pairs with the baseline are;
/// the default baseline is the first group.
inline constexpr std::size_t kMostGroupsInPairs = 8;

/// Compares the jobs of `sweep`, whose rows of results.csv are `results`. Throws Error of the command line for: keys
/// that are not swept; a metric that does not exist, is not a result, holds no numbers or has no value in any job; an
/// unknown baseline; and a condition with unknown columns or without matching jobs.
Comparison compare(const Sweep& sweep, const std::vector<Row>& results, const CompareQuery& query);

}  // namespace palpate
