// SPDX-License-Identifier: MIT
// The jobs of a sweep by what their keys say: the one place that groups them. Tables, pictures, `palpate pareto` and
// `palpate compare` begin here; the page of a sweep, whose reader chooses the keys, groups in sweep_numbers.js, and its
// tests hold it to the numbers of these.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "record/row.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// A job and its row of results.csv, null until it has ended.
struct JobResult {
  const Job* job = nullptr;
  const Row* row = nullptr;
};

/// Jobs that agree in some keys, in the order of the sweep.
struct JobGroup {
  std::vector<std::string>
      values;  ///< one for each of the keys; "" where the plugins of these jobs have no such option
  std::vector<JobResult> jobs;
};

/// Returns the values of a group for people, each on one line; "(none)" of an option that its jobs do not have, as
/// nothing would look like a slip.
std::vector<std::string> shown_values(const std::vector<std::string>& values);

/// All jobs by the values of `keys`, which are swept ones. Groups stand in the order of their first jobs; with no keys
/// there is one. `sweep` and `results` must outlive what is returned.
std::vector<JobGroup> group_jobs(const Sweep& sweep, const std::vector<Row>& results,
                                 const std::vector<std::string>& keys);

/// The values of a column in those jobs that are done and have one, ascending. Throws Error as value_of_job().
std::vector<double> values_of(const JobGroup& group, const std::string& column, const std::string& option);

/// The swept keys that make a setting: all but the seed.
std::vector<std::string> setting_keys(const Sweep& sweep);

/// Those of `keys` that have more than one value in the sweep.
std::vector<std::string> varying_keys(const Sweep& sweep, const std::vector<std::string>& keys);

/// Returns the keys that say what is tapped and have several values: `scene` and all below it. Results on one scene say
/// nothing about another, so means, bands and fronts are made of the jobs of one scene.
std::vector<std::string> scene_keys(const Sweep& sweep);

/// Throws Error, of the command line, unless `keys`, which --by names, make groups: swept ones but the seed, each once.
void check_group_keys(const Sweep& sweep, const std::vector<std::string>& keys);

/// Returns the column that --metric names, which is a result also where a swept key has its name: see result_of().
/// Throws Error, of the command line, for what is swept and no result, and as find_column() does.
Column find_metric(const Sweep& sweep, const std::string& name, const std::vector<std::string>& columns);

/// A condition on the columns of results.csv, which leaves jobs out.
class JobCondition {
 public:
  /// `where` is null for none. All must outlive the object.
  JobCondition(const Sweep& sweep, const std::vector<std::string>& columns, const Condition* where);

  /// Throws Error for a column that there is not.
  bool keeps(const JobResult& job) const;

 private:
  const Sweep& sweep_;
  const std::vector<std::string>& columns_;
  const Condition* where_;
  std::vector<std::string> names_;  ///< columns, then keys that are none
};

/// The unit of statistics that each job belongs to: the one place with this rule. Seeds are the units if the seed is
/// swept and has more than one value: jobs with the same seed share all that is drawn, so they are not independent
/// observations. Otherwise jobs are the units, and copies of a run, which have the same results in all columns that do
/// not depend on the machine, are one unit.
class JobUnits {
 public:
  /// `sweep` must outlive the object.
  JobUnits(const Sweep& sweep, const std::vector<Row>& results);

  bool are_seeds() const { return are_seeds_; }

  /// Returns the name of the job's unit, "" for a job that has not ended where jobs are the units.
  std::string of(const JobResult& job) const;

 private:
  const Sweep& sweep_;
  bool are_seeds_ = false;
  std::set<std::string> compared_;  ///< columns, where jobs are the units
};

/// Sorts values into the clusters that their units (JobUnits) name, in the order in which units come first.
class UnitClusters {
 public:
  void add(const std::string& unit, double value);
  const Clusters& clusters() const { return clusters_; }

 private:
  std::map<std::string, std::size_t> places_;
  Clusters clusters_;
};

/// The value of a key in a job; "" where it is not swept.
std::string value_of(const Sweep& sweep, const Job& job, const std::string& key);

/// What a job has of some keys: "acquisition=weighted, taps=17", or "weighted, 17" where the keys go without saying, on
/// one line. A key without a value is left out.
std::string key_words(const Sweep& sweep, const Job& job, const std::vector<std::string>& keys, bool with_keys);

}  // namespace palpate
