// SPDX-License-Identifier: MIT
// The Pareto front of cost and error over the settings of a sweep, each averaged over its seeds. For output see
// analysis/pareto_report.hpp.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// All jobs that differ in the seed alone.
struct Setting {
  std::vector<std::string> values;  ///< one per key of Pareto::keys
  std::string name;                 ///< "acquisition=weighted, taps=17": values of the keys that vary within the sweep
  std::size_t first_job = 0;        ///< index in Sweep::jobs
  std::size_t scene = 0;            ///< index in Pareto::scenes
  StatusCounts counts;              ///< without_value: lacks cost or error
  MeanEstimate cost;                ///< over the done jobs with both values; clusters: units (JobUnits)
  MeanEstimate error;
  /// Number on the front of its scene, from 1 in the order of cost; 0 if another complete setting of this scene
  /// dominates it. Settings with equal values are all on the front or all off it.
  int front = 0;

  /// Returns whether every job has both values. Incomplete settings are shown, but neither compared nor chosen: the
  /// mean over successful jobs ignores the failures.
  bool complete() const { return counts.all_are(ValueStatus::counted); }
};

struct Pareto {
  Column cost;
  Column error;
  std::vector<std::string> keys;    ///< swept keys except the seed
  std::vector<std::string> scenes;  ///< "scene=ring"; one "" if the sweep has one scene (see scene_keys())
  std::vector<Setting> settings;    ///< sorted by scene and cost; settings without a value come last
  int jobs = 0;
  int unfinished = 0;
  bool by_seed = false;  ///< whether seeds are the units (JobUnits)

  bool more_is_better() const { return error.better == RecordField::Better::more; }
};

/// Groups the results of `sweep` by all keys except the seed. Jobs that do not satisfy `where` (null for no condition)
/// are left out. Throws Error of the command line for a column that does not exist, holds no numbers, or cannot be a
/// cost or an error.
Pareto make_pareto(const Sweep& sweep, const std::vector<Row>& results, const std::string& cost,
                   const std::string& error, const Condition* where = nullptr);

/// A point of cost and loss, as an argument of front_of().
struct FrontPoint {
  std::size_t index = 0;
  std::size_t scene = 0;
  double cost = 0.0;
  double loss = 0.0;  ///< the error, or its negative if more is better
};

/// Returns the indices of the points that no other point of their scene dominates. A point dominates another if it is
/// at least as good in cost and loss and better in one; equal points are all on the front or all off it. The points are
/// sorted by scene, then cost; the result keeps their order.
std::vector<std::size_t> front_of(const std::vector<FrontPoint>& points);

/// Returns whether a column can be the error of a front. Coverages of 95 % intervals cannot: they are best at 0.95,
/// neither at their least nor at their greatest value.
bool can_be_error(const Column& column);
/// Returns whether a column can be the cost of a front, which excludes columns of which more is better.
bool can_be_cost(const Column& column);

/// Returns the number in the text of `--within`, in the unit of the error. Throws Error for an invalid text, and for
/// several scenes, whose best settings may differ.
double read_bound(const Pareto& pareto, const std::string& within);

/// Returns the complete setting with the least mean cost whose interval of the error satisfies `bound` at its worse
/// end: the upper end, or the lower end if more is better. Of settings with equal cost it takes the one with the better
/// error. Returns null if there is none; settings without an interval (one seed, equal values) are never chosen.
const Setting* cheapest_within(const Pareto& pareto, double bound);

/// Returns the complete setting whose interval of the error has the best worse end, at any cost; null if none has an
/// interval.
const Setting* best_bounded(const Pareto& pareto);

}  // namespace palpate
