// SPDX-License-Identifier: MIT
// Curves of groups over their taps: the mean of a summary field with its 95 % interval, against taps or robot time. The
// command, figures, CSV, pages and Python show these numbers.
#pragma once

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/statistics.hpp"
#include "sweep/condition.hpp"
#include "sweep/sweep.hpp"
#include "sweep/tap_summaries.hpp"

#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Columns against which curves can be drawn.
inline constexpr const char* kAgainstTaps = "taps";
inline constexpr const char* kAgainstTime = "robot_seconds";

/// Values of some columns of one job after 1, 2, ... taps; NaN for no value.
using TapValues = std::map<std::string, std::vector<double>>;

/// Returns whether any job has a value of the column after some tap.
bool any_has(const std::vector<TapValues>& jobs, const std::string& column);

/// Returns a function that stores the columns of each job in `values`, which has an element per job. Jobs without kept
/// summaries leave their element empty. `values` must outlive the function.
TapSummaries::Use keep_values(std::vector<TapValues>& values, std::vector<std::string> columns);

struct CurvesQuery {
  std::vector<std::string> by;         ///< swept keys; jobs with equal values of them and of the scene form a group
  std::string metric;                  ///< column of results.csv
  std::string against = kAgainstTaps;  ///< kAgainstTaps or kAgainstTime
  const Condition* where = nullptr;    ///< condition on columns of results.csv; other jobs are left out; null for none
  bool students = false;  ///< whether all intervals are Student's t, as on pages, which is fast; else as in
                          ///< mean_of_sample()
};

struct CurvePoint {
  double at = 0.0;    ///< taps or seconds
  MeanEstimate mean;  ///< over the jobs with a value at this point; clusters: JobUnits
};

struct GroupCurve {
  std::vector<std::string> scene;   ///< values of GroupCurves::scenes
  std::vector<std::string> values;  ///< values of GroupCurves::by
  StatusCounts counts;              ///< counts of the group's jobs; without_value: no value at any point
  int ended = 0;                    ///< counted jobs with fewer taps than others of the group
  std::vector<CurvePoint> points;   ///< with ascending `at`; empty if no job has a value

  std::string name() const;        ///< returns "weighted, rbf"; "all jobs" if no key forms groups
  std::string scene_name() const;  ///< returns "ring"; "" if the sweep has one scene or the scene is in `by`
};

struct GroupCurves {
  Column metric;
  Column against;
  std::vector<std::string> scenes;  ///< scene_keys() that are not in `by`; each of their values has its own curves
  std::vector<std::string> by;
  bool by_seed = false;            ///< whether seeds are the units (JobUnits)
  int jobs = 0;                    ///< number of jobs of the sweep
  std::vector<GroupCurve> curves;  ///< in the order of the sweep, scene by scene

  /// Returns the names of the scenes with curves, in their order; one "" for a sweep with one scene.
  std::vector<std::string> scene_names() const;
};

/// Returns the default keys of groups: all keys that vary except the seed and the keys of the scene.
std::vector<std::string> curve_keys(const Sweep& sweep);

/// Makes the curves of the jobs of `sweep`, whose rows of results.csv are `results`. `values` hold at least the metric
/// and the axis.
///
/// Against taps, a group has one point per tap up to the longest of its jobs. Against robot time, it has 60 points,
/// from the time at which all its jobs have made a tap to the end of its last job; a job counts with its value after
/// its last tap by then. A job that has ended counts with its final value, as in `compare --at`. Jobs that failed or
/// have not ended are left out. Throws Error of the command line as compare() does, and if there is nothing to draw.
GroupCurves make_group_curves(const Sweep& sweep, const std::vector<Row>& results, const std::vector<TapValues>& values,
                              const CurvesQuery& query);

}  // namespace palpate
