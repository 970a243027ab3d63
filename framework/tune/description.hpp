// SPDX-License-Identifier: MIT
// Description of a tuning: the block `tune:` of a config together with the command line.
#pragma once

#include "config/expand.hpp"
#include "sweep/where_condition.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A key whose value is searched: a list of values, or a continuous range.
struct TunedKey {
  std::string key;
  std::vector<Tree> values;              ///< empty if `range` is set; else at least two
  std::optional<ContinuousRange> range;  ///< set if the value is `uniform(...)` or `log_uniform(...)`
  Tree written;                          ///< as in the config; its location is named in errors

  /// Returns the position of a value that was written in a config: its index in the list, or its number in the unit of
  /// the range. Values are compared as quantities, too: 1.7 cm is 17 mm. Returns nullopt for a value that is not in the
  /// list, and for a value that is not a quantity in the dimension of the range.
  std::optional<double> position(const std::string& text) const;
};

/// The words of `palpate tune CONFIG` that replace parts of the block `tune:`.
struct TuneWords {
  std::vector<std::string> keys;                              ///< KEY=VALUES
  std::vector<std::string> scenes;                            ///< values of `over.scene`
  std::vector<std::pair<std::string, std::string>> settings;  ///< metric, jobs, ...: name and YAML value
};

/// The checked description. Example of its block:
///
///     tune:
///       keys: {kernel.length_scale: "log_uniform(5 mm, 10 cm)", acquisition: [weighted, uncertainty]}
///       metric: rmse_m      field of the summary; its mean is minimised or, if more is better, maximised
///       cost: robot_seconds second metric, of which less is better; the race then keeps the Pareto front of both
///       jobs: 400           budget: number of runs, without those of `fresh`; or `time: 10 min`
///       within: 0.5 mm      end when all settings left differ from the best one by at most this; default 0
///       fresh: 100          number of seeds for the comparison of the best setting with the config as it stands
///       over: [block, ring] scenes that alternate from seed to seed; default: the scene of the config
///       where: kernel.length_scale > 1 cm   condition on the settings
///
/// A key with a single value is not searched: all runs have this value.
struct TuneDescription {
  /// `config`: the config's `tune:`, or null. Throws Error for an invalid description.
  TuneDescription(const Tree* config, const TuneWords& words);

  std::vector<TunedKey> keys;       ///< at least one
  std::vector<SweepAxis> fixed;     ///< keys with a single value
  std::optional<SweepAxis> scenes;  ///< key `scene` with the values of `over`
  std::string metric;               ///< a number in every summary that has it; less or more is better
  bool more_is_better = false;      ///< whether larger values of the metric are better
  std::optional<std::string> cost;  ///< second metric, of which less is better: the race keeps the Pareto front
  std::optional<std::size_t> jobs;  ///< budget in runs
  std::optional<double> seconds;    ///< budget in seconds of wall time; either this or `jobs` is set
  double within = 0.0;              ///< in the unit of the metric (SI)
  std::size_t fresh = 100;          ///< number of fresh seeds
  std::vector<WhereCondition> where;
  Tree written;  ///< block `tune:` that gives the same description

  /// Returns the keys of the jobs in the order of Job::values: `scene` if there are several, all keys, and `seed`.
  std::vector<std::string> job_keys() const;

 private:
  void read_keys(ValueCount& count);
  void read_metric();
  void read_budget();
};

}  // namespace palpate
