// SPDX-License-Identifier: MIT
// Groups of a sweep's jobs by the values of keys, and the units of their statistics. Tables, pictures, `palpate pareto`
// and `palpate compare` use them. On the page of a sweep, the reader chooses the keys, and sweep_numbers.js forms the
// groups.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "record/row.hpp"
#include "sweep/sweep.hpp"
#include "sweep/where_condition.hpp"

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// A job with its row of results.csv. The row is null until the job has ended.
struct JobResult {
  const Job* job = nullptr;
  const Row* row = nullptr;
};

/// Jobs with equal values of some keys, in the order of the sweep.
struct JobGroup {
  std::vector<std::string> values;  ///< one per key; "" if the plugins of these jobs have no such option
  std::vector<JobResult> jobs;
};

/// Returns the values of a group for display, each on one line. An option that the jobs lack is shown as "(none)".
std::vector<std::string> shown_values(const std::vector<std::string>& values);

/// Groups all jobs by their values of `keys`, which must be swept keys. The groups are in the order of their first
/// jobs. If there are no keys, there is one group. `sweep` and `results` must outlive the result.
std::vector<JobGroup> group_jobs(const Sweep& sweep, const std::vector<Row>& results,
                                 const std::vector<std::string>& keys);

/// Returns the values of a column in ascending order, over the done jobs that have a value. Throws the errors of
/// value_of_job().
std::vector<double> values_of(const JobGroup& group, const std::string& column, const std::string& option);

/// Returns `names` except those in `without`.
std::vector<std::string> others(const std::vector<std::string>& names, const std::vector<std::string>& without);

/// Returns the swept keys that define a setting: all except the seed.
std::vector<std::string> setting_keys(const Sweep& sweep);

/// Returns the keys among `keys` that have several values in the sweep.
std::vector<std::string> varying_keys(const Sweep& sweep, const std::vector<std::string>& keys);

/// Returns the swept keys of the tapped scene (`scene` and `scene.*`) that have several values. Results on different
/// scenes are not comparable. A mean, a band or a front therefore uses only the jobs of one scene.
std::vector<std::string> scene_keys(const Sweep& sweep);

/// Throws Error with the place "command line" unless the keys of --by can form groups. The keys must be swept, differ
/// from each other, and not include the seed.
void check_group_keys(const Sweep& sweep, const std::vector<std::string>& keys);

/// Returns the column of --metric. A name that is both a swept key and a result refers to the result (see result_of()).
/// Throws Error with the place "command line" for a swept key that is not a result, and the errors of find_column().
Column find_metric(const Sweep& sweep, const std::string& name, const std::vector<std::string>& columns);

/// A condition on the columns of results.csv, which selects jobs.
class JobCondition {
 public:
  /// If `where` is null, there is no condition. All arguments must outlive the object.
  JobCondition(const Sweep& sweep, const std::vector<std::string>& columns, const WhereCondition* where);

  /// Returns whether the job satisfies the condition. Throws Error for an unknown column.
  bool keeps(const JobResult& job) const;

 private:
  const Sweep& sweep_;
  const std::vector<std::string>& columns_;
  const WhereCondition* where_;
  /// names that the condition may use: the columns, then the swept keys that are not columns
  std::vector<std::string> names_;
};

/// The unit of statistics of each job. If several seeds are swept, seeds are the units, because jobs with the same seed
/// share all random draws and are not independent. Otherwise jobs are the units, and copies of a run form one unit.
/// Copies have equal values in all columns that do not depend on the machine.
class StatisticalUnits {
 public:
  /// `sweep` must outlive the object.
  StatisticalUnits(const Sweep& sweep, const std::vector<Row>& results);

  bool are_seeds() const { return are_seeds_; }

  /// Returns the name of the job's unit. If jobs are the units, a job that has not ended has the name "".
  std::string of(const JobResult& job) const;

 private:
  const Sweep& sweep_;
  bool are_seeds_ = false;
  std::set<std::string> compared_;  ///< columns in which copies of a run must be equal; used if jobs are the units
};

/// Sorts values into clusters, one per unit of StatisticalUnits, in the order in which units first appear.
class UnitClusters {
 public:
  void add(const std::string& unit, double value);
  const Clusters& clusters() const { return clusters_; }

 private:
  std::map<std::string, std::size_t> places_;
  Clusters clusters_;
};

/// Returns the value of a key in a job; "" if the key is not swept.
std::string value_of(const Sweep& sweep, const Job& job, const std::string& key);

/// Returns a job's values of some keys on one line: "acquisition=weighted, taps=17". If `with_keys` is not set, returns
/// "weighted, 17". Keys without a value are left out.
std::string key_words(const Sweep& sweep, const Job& job, const std::vector<std::string>& keys, bool with_keys);

}  // namespace palpate
