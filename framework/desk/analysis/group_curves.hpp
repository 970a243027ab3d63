// SPDX-License-Identifier: MIT
// Groups of a sweep's jobs over their taps: any number of the summary against taps or robot time, as a mean with its
// 95 % interval at each point. Command, figures, CSV, page and Python all show these numbers.
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

/// The columns that curves may be drawn against.
inline constexpr const char* kAgainstTaps = "taps";
inline constexpr const char* kAgainstTime = "robot_seconds";

/// The values of some columns in one job after 1, 2, ... taps; NaN where there is none.
using TapValues = std::map<std::string, std::vector<double>>;

/// Whether a job has a value in that column after some tap.
bool any_has(const std::vector<TapValues>& jobs, const std::string& column);

/// Returns what puts them into `values`, which has a place for each job: empty for a job without kept summaries.
/// `values` must outlive it.
TapSummaries::Use keep_values(std::vector<TapValues>& values, std::vector<std::string> columns);

struct CurvesQuery {
  std::vector<std::string> by;  ///< swept keys; jobs that have the same values of them, and of the scene, are a group
  std::string metric;           ///< a column of results.csv
  std::string against = kAgainstTaps;  ///< kAgainstTaps or kAgainstTime
  const Condition* where = nullptr;    ///< on the columns of results.csv: other jobs are left out; null for none
  bool students = false;               ///< intervals by Student's t alone, as the page has them, which takes no time
};

struct CurvePoint {
  double at = 0.0;    ///< taps, or seconds
  MeanEstimate mean;  ///< over the jobs that have a value there; clusters: JobUnits
};

struct GroupCurve {
  std::vector<std::string> scene;   ///< its values of GroupCurves::scenes
  std::vector<std::string> values;  ///< of GroupCurves::by
  StatusCounts counts;              ///< of its jobs; without a value: at no point
  int ended = 0;                    ///< of those that count, the ones that made fewer taps than others of the group
  std::vector<CurvePoint> points;   ///< at ascending `at`; none where no job has a value

  std::string name() const;        ///< "weighted, rbf"; "all jobs" where no key makes groups
  std::string scene_name() const;  ///< "ring"; "" where the sweep has one scene, or the scene is a key of the groups
};

struct GroupCurves {
  Column metric;
  Column against;
  std::vector<std::string> scenes;  ///< scene_keys() that are not in `by`: each of their values has curves of its own
  std::vector<std::string> by;
  bool by_seed = false;            ///< seeds are the units: see JobUnits
  int jobs = 0;                    ///< of the sweep
  std::vector<GroupCurve> curves;  ///< in the order of the sweep, those of a scene together

  /// Returns the names of the scenes that have curves, in their order; one "" where the sweep has one.
  std::vector<std::string> scene_names() const;
};

/// Returns the keys that make groups where nobody names any: all that vary, but for the seed and the scene's.
std::vector<std::string> curve_keys(const Sweep& sweep);

/// Makes the curves of the jobs of `sweep`, whose rows of results.csv are `results` and whose `values` hold at least
/// the metric and the axis. Of taps a group has a point after each tap up to the most that one of its jobs made. Of
/// robot time it has 60 from the time at which all its jobs have made a tap to the end of its last job; a job then
/// counts as it was after its last tap by then. A job that has ended counts as it ended, as in `compare --at`; jobs
/// that failed or have not ended are in no point. Throws Error, of the command line, as compare() does, and where there
/// is nothing to draw.
GroupCurves make_group_curves(const Sweep& sweep, const std::vector<Row>& results, const std::vector<TapValues>& values,
                              const CurvesQuery& query);

}  // namespace palpate
