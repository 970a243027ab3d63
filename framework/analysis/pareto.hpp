// SPDX-License-Identifier: MIT
// The Pareto front of cost and error over the settings of a sweep. Each setting is averaged over its seeds. The output
// is in analysis/pareto_report.hpp.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "sweep/sweep.hpp"
#include "sweep/where_condition.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// All jobs that differ only in the seed.
struct Setting {
  std::vector<std::string> values;  ///< one value per key of Pareto::keys
  std::string name;                 ///< "acquisition=weighted, taps=17": values of the keys that vary within the sweep
  std::size_t first_job = 0;        ///< index in Sweep::jobs
  std::size_t scene = 0;            ///< index in Pareto::scenes
  StatusCounts counts;              ///< numbers of jobs by status; `without_value` jobs lack cost or error
  /// mean over the done jobs with both values; the clusters are the units of StatisticalUnits
  MeanEstimate cost;
  MeanEstimate error;
  /// Number of the setting on the front of its scene, counted from 1 in the order of cost. It is 0 if the setting is
  /// incomplete, or if another complete setting of the scene dominates it. Settings with equal values are either all on
  /// the front or all off it.
  int front = 0;

  /// Returns whether every job has both values. Incomplete settings are shown, but neither compared nor chosen, because
  /// a mean over the successful jobs would ignore the failures.
  bool complete() const { return counts.all_are(ValueStatus::counted); }
};

struct Pareto {
  Column cost;
  Column error;
  std::vector<std::string> keys;    ///< swept keys except the seed
  std::vector<std::string> scenes;  ///< "scene=ring"; one "" if the sweep has one scene (see scene_keys())
  /// sorted by scene, then by cost; settings without a value come last in their scene
  std::vector<Setting> settings;
  int jobs = 0;
  int unfinished = 0;
  bool by_seed = false;  ///< whether seeds are the units (StatisticalUnits)

  bool more_is_better() const { return error.better == RecordField::Better::more; }
};

/// Groups the results of `sweep` by all keys except the seed. Jobs that do not satisfy `where` (null for no condition)
/// are left out. Throws Error with the place "command line" for a column that does not exist, holds no numbers, or
/// cannot be a cost or an error.
Pareto make_pareto(const Sweep& sweep, const std::vector<Row>& results, const std::string& cost,
                   const std::string& error, const WhereCondition* where = nullptr);

/// A point with cost and loss, an argument of front_of().
struct FrontPoint {
  std::size_t index = 0;
  std::size_t scene = 0;
  double cost = 0.0;
  double loss = 0.0;  ///< the error, or its negative if more is better
};

/// Returns the indices of the points that no other point of their scene dominates. A point dominates another if it is
/// at least as good in cost and loss and better in one. Equal points are either all on the front or all off it. The
/// points must be sorted by scene, then by cost. The result keeps their order.
std::vector<std::size_t> front_of(const std::vector<FrontPoint>& points);

/// Returns whether a column can be the error of a front. A coverage of 95 % intervals cannot, because its best value is
/// 0.95, not the least or greatest.
bool can_be_error(const Column& column);
/// Returns whether a column can be the cost of a front. A column of which more is better cannot.
bool can_be_cost(const Column& column);

/// Returns the number in the text of `--within`, which is in the unit of the error. Throws Error if the text is
/// invalid, and if there are several scenes, whose best settings may differ.
double read_bound(const Pareto& pareto, const std::string& within);

/// Returns the cheapest complete setting whose error satisfies `bound` at the worse end of its interval. The worse end
/// is the upper end, or the lower end if more is better. Among settings with equal cost, returns the setting with the
/// best error. Returns null if there is no such setting. Settings without an interval (one seed, or equal values) are
/// never chosen.
const Setting* cheapest_within(const Pareto& pareto, double bound);

/// Returns the complete setting whose error is best at the worse end of its interval, whatever its cost. Returns null
/// if no setting has an interval.
const Setting* best_bounded(const Pareto& pareto);

}  // namespace palpate
