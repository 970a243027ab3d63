// SPDX-License-Identifier: MIT
#include "report/page/sweep_curves.hpp"

#include "analysis/group_curves_report.hpp"
#include "report/colours.hpp"
#include "report/page/sweep_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {
namespace {

/// Largest number of groups per scene. Each colour is used twice: for a solid and for a dashed line.
constexpr std::size_t kMostGroupsOfAScene = 2 * kLineColours.size();

/// Returns the choices of keys for groups: all keys together, then each key alone. Choices with too many groups are
/// left out.
std::vector<std::vector<std::string>> choices_of_keys(const Sweep& sweep) {
  const std::vector<std::string> all = curve_keys(sweep);
  std::vector<std::vector<std::string>> out;
  const auto add = [&](const std::vector<std::string>& keys) {
    if (group_jobs(sweep, {}, keys).size() <= kMostGroupsOfAScene) out.push_back(keys);
  };
  if (all.size() != 1) add(all);
  for (const std::string& key : all) add({key});
  return out;
}

Json json_of_curve(const GroupCurve& curve) {
  std::vector<double> at;
  std::vector<std::optional<double>> mean, low, high;
  std::vector<std::size_t> jobs;
  for (const CurvePoint& point : curve.points) {
    const auto& ends = point.mean.interval;
    at.push_back(point.at);
    jobs.push_back(point.mean.count);
    mean.push_back(point.mean.count > 0 ? std::optional(point.mean.mean) : std::nullopt);
    low.push_back(ends ? std::optional(ends->low) : std::nullopt);
    high.push_back(ends ? std::optional(ends->high) : std::nullopt);
  }
  return {{"scene", curve.scene_name()},
          {"name", curve.name()},
          {"at", at},
          {"mean", mean},
          {"low", low},
          {"high", high},
          {"jobs", jobs}};
}

Json json_of_set(const GroupCurves& made) {
  Json curves = Json::array();
  for (const GroupCurve& curve : made.curves) {
    if (!curve.points.empty()) curves.push_back(json_of_curve(curve));
  }
  return {{"metric", made.metric.name},
          {"against", made.against.name},
          {"over", curve_units_words(made)},
          {"remarks", curve_remarks(made)},
          {"curves", curves}};
}

}  // namespace

Json json_of_curves(const Sweep& sweep) {
  if (sweep.jobs.size() > kMostJobsOnAPage || !TapSummaries::any_kept(sweep)) return {};
  const std::vector<Row> results = sweep_results(sweep);
  const std::vector<std::vector<std::string>> keys = choices_of_keys(sweep);
  if (keys.empty()) return {};
  std::vector<std::string> metrics = headline_fields(results);
  std::vector<std::string> read = metrics;
  read.emplace_back(kAgainstTime);
  std::vector<TapValues> values(sweep.jobs.size());
  const TapSummaries summaries(sweep, keep_values(values, read));
  if (!summaries.missing().empty()) return {};
  const auto is_left_out = [&, first = metrics.front()](const std::string& column) {
    const bool is_swept = std::find(sweep.keys.begin(), sweep.keys.end(), column) != sweep.keys.end();
    return column == kAgainstTime || (is_swept && column != first) || !any_has(values, column);
  };
  metrics.erase(std::remove_if(metrics.begin(), metrics.end(), is_left_out), metrics.end());
  if (metrics.empty()) return {};
  const bool takes_time = std::any_of(values.begin(), values.end(), [](const TapValues& job) {
    const auto found = job.find(kAgainstTime);
    return found != job.end() && found->second.back() > 0.0;
  });
  Json by = Json::array();
  Json sets = Json::array();
  for (const std::vector<std::string>& one : keys) {
    by.push_back(one.empty() ? "all jobs" : fmt::format("{}", fmt::join(one, ", ")));
    for (const std::string& metric : metrics) {
      for (const char* const against : {kAgainstTaps, kAgainstTime}) {
        if (against == kAgainstTime && !takes_time) continue;
        sets.push_back(json_of_set(make_group_curves(sweep, results, values, {one, metric, against, nullptr, true})));
        sets.back()["by"] = by.back();
      }
    }
  }
  return {{"metrics", metrics}, {"by", by}, {"sets", sets}};
}

}  // namespace palpate
