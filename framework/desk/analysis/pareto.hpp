// SPDX-License-Identifier: MIT
// What accuracy costs: the settings of a sweep, each over its seeds, and those that no other beats in both cost and
// error. analysis/pareto_report.hpp shows them.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// All jobs that differ in nothing but the seed.
struct Setting {
  std::vector<std::string> values;  ///< one for each of Pareto::keys
  std::string name;                 ///< "acquisition=weighted, taps=17": the keys that differ within the sweep
  std::size_t first_job = 0;        ///< index in Sweep::jobs
  std::size_t scene = 0;            ///< index in Pareto::scenes
  StatusCounts counts;              ///< without a value: of cost or error
  MeanEstimate cost;                ///< over the jobs that are done and have both values; clusters: their units
  MeanEstimate error;
  /// Its number on the front of its scene, from 1 in the order of cost; 0 if it is not on it: another complete one of
  /// this scene is at least as good in both and better in one. Equal ones are on it together or not at all.
  int front = 0;

  /// Whether every job has both values. Others are shown, but the front is made, and the cheapest chosen, without them:
  /// the mean of the jobs that went well says nothing about those that did not.
  bool complete() const { return counts.all_are(ValueStatus::counted); }
};

struct Pareto {
  Column cost;
  Column error;
  std::vector<std::string> keys;    ///< the swept ones but the seed
  std::vector<std::string> scenes;  ///< "scene=ring"; one "" where the sweep has one: see scene_keys()
  std::vector<Setting> settings;    ///< of each scene in the order of cost, those without a value last
  int jobs = 0;
  int unfinished = 0;
  bool by_seed = false;  ///< seeds are the units: see JobUnits

  bool more_is_better() const { return error.better == RecordField::Better::more; }
};

/// Groups the results of `sweep` by all keys but the seed. Jobs of which `where` (may be null) does not hold belong to
/// no setting. Throws Error, of the command line, for a column that does not exist, holds no numbers, is best neither
/// small nor large (coverage_95), or, as cost, is better when it is more.
Pareto make_pareto(const Sweep& sweep, const std::vector<Row>& results, const std::string& cost,
                   const std::string& error, const Condition* where = nullptr);

/// One of the points among which front_of() finds those that are not dominated.
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

/// Returns whether a column can be the error of a front: its best value is the least or the greatest one, which for a
/// coverage of 95 % intervals is 0.95.
bool can_be_error(const Column& column);
/// Returns whether a column can be the cost of a front: less of it is better, or neither.
bool can_be_cost(const Column& column);

/// Reads what `--within` says, in the unit of the error. Throws Error, also where there are several scenes: what is
/// best on one is not what is best on another.
double read_bound(const Pareto& pareto, const std::string& within);

/// The complete setting of the least mean cost whose interval keeps to `bound` at its cautious end: the upper one, or
/// the lower where more is better. Of equal costs the one with the better error. Null if there is none. A setting of
/// one seed, or of equal values, has no interval and is never chosen.
const Setting* cheapest_within(const Pareto& pareto, double bound);

/// The complete setting whose interval ends best, whatever it costs. Null if none has an interval.
const Setting* best_bounded(const Pareto& pareto);

}  // namespace palpate
