// SPDX-License-Identifier: MIT
// Curves of groups of jobs: the mean of a summary field with its 95 % interval, against taps or robot time. The command
// `palpate curves`, figures, CSV files, pages and the Python module show these numbers.
#pragma once

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/statistics.hpp"
#include "sweep/sweep.hpp"
#include "sweep/tap_summaries.hpp"
#include "sweep/where_condition.hpp"

#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Columns against which curves can be drawn.
inline constexpr const char* kAgainstTaps = "taps";
inline constexpr const char* kAgainstTime = "robot_seconds";

/// Values of some columns of one job after 1, 2, ... taps; NaN for no value.
using TapValues = std::map<std::string, std::vector<double>>;

/// Returns whether any job has a value of the column after at least one tap.
bool any_has(const std::vector<TapValues>& jobs, const std::string& column);

/// Returns a function that stores the columns of each job in `values`, which has one element per job. The elements of
/// jobs without stored summaries stay empty. `values` must outlive the function.
TapSummaries::Use keep_values(std::vector<TapValues>& values, std::vector<std::string> columns);

struct CurvesQuery {
  /// swept keys; jobs with equal values of these keys and of the scene form a group
  std::vector<std::string> by;
  std::string metric;                  ///< column of results.csv
  std::string against = kAgainstTaps;  ///< kAgainstTaps or kAgainstTime
  const WhereCondition* where =
      nullptr;  ///< condition on columns of results.csv; other jobs are left out; null for none
  /// Whether all intervals are Student's t intervals, which are fast to compute and used on pages. Otherwise
  /// mean_of_sample() computes the intervals.
  bool students = false;
};

struct CurvePoint {
  double at = 0.0;    ///< position on the axis: taps or seconds
  MeanEstimate mean;  ///< mean over the jobs with a value at this point; the clusters are the units of StatisticalUnits
};

struct GroupCurve {
  std::vector<std::string> scene;   ///< values of the keys GroupCurves::scenes
  std::vector<std::string> values;  ///< values of the keys GroupCurves::by
  /// counts of the group's jobs by status; `without_value` are jobs without a value at any point
  StatusCounts counts;
  int ended = 0;                   ///< number of counted jobs that have fewer taps than other jobs of the group
  std::vector<CurvePoint> points;  ///< with ascending `at`; empty if no job has a value

  std::string name() const;        ///< returns "weighted, rbf"; "all jobs" if no key forms groups
  std::string scene_name() const;  ///< returns "ring"; "" if the sweep has one scene or the scene is in `by`
};

struct GroupCurves {
  Column metric;
  Column against;
  /// the scene_keys() that are not in `by`; each combination of values of these keys has its own curves
  std::vector<std::string> scenes;
  std::vector<std::string> by;
  bool by_seed = false;            ///< whether seeds are the units (StatisticalUnits)
  int jobs = 0;                    ///< number of jobs of the sweep
  std::vector<GroupCurve> curves;  ///< in the order of the sweep, scene by scene

  /// Returns the names of the scenes with curves, in their order. For a sweep with one scene, the only name is "".
  std::vector<std::string> scene_names() const;
};

/// Returns the default keys of groups: all keys that vary except the seed and the keys of the scene.
std::vector<std::string> curve_keys(const Sweep& sweep);

/// Makes the curves of the jobs of `sweep`. `results` are the rows of results.csv. `values` must contain at least the
/// metric and the axis.
///
/// Against taps, a group has one point per tap, up to the largest number of taps of its jobs. Against robot time, a
/// group has 60 points. The first point is the time at which all jobs of the group have made a tap. The last point is
/// the end of the last job. At each point, a job counts with its value after the last tap that it has made by then. A
/// job that has ended counts with its final value, as in `compare --at`. Jobs that failed or have not ended are left
/// out. Throws the errors of compare(), and Error if there is nothing to draw.
GroupCurves make_group_curves(const Sweep& sweep, const std::vector<Row>& results, const std::vector<TapValues>& values,
                              const CurvesQuery& query);

}  // namespace palpate
