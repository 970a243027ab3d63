// SPDX-License-Identifier: MIT
#include "analysis/group_curves.hpp"

#include "analysis/bootstrap.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace palpate {
namespace {

constexpr int kTimes = 60;  ///< number of points of a curve against time

/// A counted job and its unit of statistics.
struct JobCurve {
  const std::vector<double>* metric = nullptr;
  const std::vector<double>* seconds = nullptr;  ///< robot time at the end of each tap; null for curves against taps
  std::string unit;

  /// Returns the value after the last tap that is not later than `at` (taps or seconds). Returns NaN before the first
  /// tap.
  double value(double at) const {
    std::size_t taps = std::min(static_cast<std::size_t>(std::max(at, 0.0)), metric->size());
    if (seconds != nullptr)
      taps = static_cast<std::size_t>(std::upper_bound(seconds->begin(), seconds->end(), at) - seconds->begin());
    return taps > 0 ? (*metric)[taps - 1] : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Returns the x values (taps or seconds) of the points of a group's curve.
std::vector<double> points_of(const std::vector<JobCurve>& jobs) {
  std::vector<double> out;
  if (jobs.empty()) return out;
  if (jobs.front().seconds == nullptr) {
    std::size_t most = 0;
    for (const JobCurve& job : jobs) most = std::max(most, job.metric->size());
    for (std::size_t taps = 1; taps <= most; ++taps) out.push_back(static_cast<double>(taps));
    return out;
  }
  double first = 0.0;
  double last = 0.0;
  for (const JobCurve& job : jobs) {
    first = std::max(first, job.seconds->front());
    last = std::max(last, job.seconds->back());
  }
  for (int i = 0; i < kTimes; ++i) {
    out.push_back(i + 1 == kTimes ? last : first + (last - first) * i / (kTimes - 1));
    if (last <= first) break;
  }
  return out;
}

MeanEstimate estimate_at(const std::vector<JobCurve>& jobs, double at, bool students) {
  UnitClusters units;
  for (const JobCurve& job : jobs) {
    if (const double value = job.value(at); std::isfinite(value)) units.add(job.unit, value);
  }
  MeanEstimate out = students ? estimate_mean(units.clusters()) : mean_of_sample(units.clusters());
  if (out.clusters < kLeastForInterval) out.interval.reset();
  return out;
}

bool has_value(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double one) { return std::isfinite(one); });
}

/// Returns the status of a job in the curve of its group. `metric`: values of the job after each tap; null if the job
/// has no values.
ValueStatus status_of(const JobResult& job, const std::vector<double>* metric, const JobCondition& where,
                      const CurvesQuery& query) {
  const ValueStatus status = value_of_job(job.row, query.metric, "--metric").status;
  if (!where.keeps(job)) return ValueStatus::left_out;
  if (status != ValueStatus::counted && status != ValueStatus::without_value) return status;
  return metric != nullptr && has_value(*metric) ? ValueStatus::counted : ValueStatus::without_value;
}

/// Makes the curve of a group. The first `scenes` values of `group.values` belong to the scene, and the others to the
/// keys of `--by`.
GroupCurve make_curve(const JobGroup& group, std::size_t scenes, const std::vector<TapValues>& values,
                      const StatisticalUnits& units, const JobCondition& where, const CurvesQuery& query) {
  const auto split = group.values.begin() + static_cast<std::ptrdiff_t>(scenes);
  GroupCurve curve;
  curve.scene.assign(group.values.begin(), split);
  curve.values.assign(split, group.values.end());
  std::vector<JobCurve> jobs;
  for (const JobResult& one : group.jobs) {
    const TapValues& of_job = values[static_cast<std::size_t>(one.job->index)];
    const auto found = of_job.find(query.metric);
    const std::vector<double>* const metric = found != of_job.end() ? &found->second : nullptr;
    const ValueStatus status = status_of(one, metric, where, query);
    curve.counts.add(status);
    if (status != ValueStatus::counted) continue;
    jobs.push_back({metric, query.against == kAgainstTaps ? nullptr : &of_job.at(query.against), units.of(one)});
  }
  std::size_t most = 0;
  for (const JobCurve& job : jobs) most = std::max(most, job.metric->size());
  for (const JobCurve& job : jobs) curve.ended += job.metric->size() < most ? 1 : 0;
  for (const double at : points_of(jobs)) curve.points.push_back({at, estimate_at(jobs, at, query.students)});
  return curve;
}

/// Throws Error with the reason if there is nothing to draw.
void check_points(const GroupCurves& made, const Sweep& sweep) {
  if (made.curves.empty())
    throw Error("command line", fmt::format("--where: matches none of the {} jobs", made.jobs),
                "check the values in results.csv");
  int without_value = 0;
  bool is_drawn = false;
  bool takes_time = made.against.name == kAgainstTaps;
  for (const GroupCurve& curve : made.curves) {
    without_value += curve.counts.of(ValueStatus::without_value);
    is_drawn = is_drawn || !curve.points.empty();
    takes_time = takes_time || (!curve.points.empty() && curve.points.back().at > 0.0);
  }
  if (is_drawn && takes_time) return;
  if (is_drawn) throw Error("command line", "--against: no job took any robot time", "'--against taps' needs none");
  if (without_value == 0)
    throw Error(sweep.directory.string(), "none of the jobs to draw ended well",
                "see the reasons with 'palpate status'");
  const RecordField* field = find_summary_field(made.metric.name);
  throw Error("command line", fmt::format("--metric: no job has a value of '{}' after any tap", made.metric.name),
              field != nullptr ? field->when_null : "");
}

}  // namespace

bool any_has(const std::vector<TapValues>& jobs, const std::string& column) {
  return std::any_of(jobs.begin(), jobs.end(), [&](const TapValues& job) {
    const auto found = job.find(column);
    return found != job.end() && has_value(found->second);
  });
}

TapSummaries::Use keep_values(std::vector<TapValues>& values, std::vector<std::string> columns) {
  return [&values, columns = std::move(columns)](std::size_t job, const std::vector<Row>& rows) {
    for (const std::string& column : columns) {
      std::vector<double>& of_job = values[job][column];
      of_job.clear();
      std::size_t near = 0;
      for (const Row& row : rows)
        of_job.push_back(number_of(row.find(column, near)).value.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
  };
}

std::string GroupCurve::name() const {
  return values.empty() ? "all jobs" : fmt::format("{}", fmt::join(shown_values(values), ", "));
}

std::string GroupCurve::scene_name() const { return fmt::format("{}", fmt::join(shown_values(scene), ", ")); }

std::vector<std::string> GroupCurves::scene_names() const {
  std::vector<std::string> out;
  for (const GroupCurve& curve : curves) {
    std::string name = curve.scene_name();
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

std::vector<std::string> curve_keys(const Sweep& sweep) {
  return others(varying_keys(sweep, setting_keys(sweep)), scene_keys(sweep));
}

GroupCurves make_group_curves(const Sweep& sweep, const std::vector<Row>& results, const std::vector<TapValues>& values,
                              const CurvesQuery& query) {
  if (results.empty())
    throw Error(sweep.directory.string(), "no job of this sweep has ended", "run it with 'palpate resume'");
  check_group_keys(sweep, query.by);
  const std::vector<std::string> columns = names_of(results);
  GroupCurves out;
  out.metric = find_metric(sweep, query.metric, columns);
  // Even if `taps` is a swept key, the axis is the number of taps that were made.
  out.against = query.against == kAgainstTaps ? Column{kAgainstTaps} : find_column(query.against, columns, "--against");
  out.by = query.by;
  out.jobs = static_cast<int>(sweep.jobs.size());
  for (const std::string& key : scene_keys(sweep)) {
    if (std::find(query.by.begin(), query.by.end(), key) == query.by.end()) out.scenes.push_back(key);
  }
  const StatisticalUnits units(sweep, results);
  out.by_seed = units.are_seeds();
  const JobCondition where(sweep, columns, query.where);
  std::vector<std::string> keys = out.scenes;
  keys.insert(keys.end(), query.by.begin(), query.by.end());
  for (const JobGroup& group : group_jobs(sweep, results, keys)) {
    GroupCurve curve = make_curve(group, out.scenes.size(), values, units, where, query);
    if (!curve.counts.all_are(ValueStatus::left_out)) out.curves.push_back(std::move(curve));
  }
  std::stable_sort(out.curves.begin(), out.curves.end(), [names = out.scene_names()](const auto& a, const auto& b) {
    const auto place = [&](const GroupCurve& one) { return std::find(names.begin(), names.end(), one.scene_name()); };
    return place(a) < place(b);
  });
  check_points(out, sweep);
  return out;
}

}  // namespace palpate
