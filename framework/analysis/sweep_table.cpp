// SPDX-License-Identifier: MIT
#include "analysis/sweep_table.hpp"

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/statistics.hpp"
#include "analysis/table.hpp"
#include "record/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace palpate {
namespace {

/// Numbers of a group before they are formatted.
struct SweepTableRow {
  std::string name;
  std::size_t scene = 0;  ///< index of the group's scene
  int runs = 0;
  int without_contact = 0;
  int found = 0;
  int failed = 0;
  bool is_initial_known = false;
  std::vector<double> object_taps_rest, object_taps_all, rmse, iou;  ///< values of the done jobs, ascending

  /// Returns the number by which the groups of a scene are sorted: the median RMSE, or infinity for a group without an
  /// RMSE.
  double median_rmse() const { return rmse.empty() ? std::numeric_limits<double>::infinity() : quantile(rmse, 0.5); }
};

/// Returns "5.4 (4.5-6.3)": the median, and the 10 % and 90 % quantiles.
std::string spread(const std::vector<double>& values, const DisplayScale& scale) {
  if (values.empty()) return "-";
  return fmt::format("{} ({}-{})", scale.number(quantile(values, 0.5)), scale.number(quantile(values, 0.1)),
                     scale.number(quantile(values, 0.9)));
}

SweepTableRow row_of(const JobGroup& group, const std::string& error, const InitialTaps& initial_taps) {
  SweepTableRow out;
  // Largest number of jobs whose configs are read. One config would suffice, but it may be damaged.
  constexpr std::size_t kMostAsked = 3;
  std::optional<int> initial;  // number of initial taps, equal for all jobs of a group
  std::size_t asked = 0;
  for (const auto& [job, row] : group.jobs) {
    if (initial || asked == kMostAsked) break;
    if (row == nullptr) continue;
    ++asked;
    initial = initial_taps(static_cast<std::size_t>(job->index), *row);
  }
  for (const auto& [job, row] : group.jobs) {
    if (row == nullptr) continue;
    ++out.runs;
    if (!is_done(*row)) {
      ++out.failed;
      continue;
    }
    const std::optional<double> hit = row->number("first_hit_tap");
    const bool is_without_contact = !hit || !initial || *hit > *initial;
    out.without_contact += is_without_contact ? 1 : 0;
    out.found += hit ? 1 : 0;
    const auto add = [&, of = row](std::vector<double>& values, const std::string& field) {
      if (const auto value = of->number(field)) values.push_back(*value);
    };
    add(out.object_taps_all, "object_taps");
    add(out.rmse, error);
    add(out.iou, "footprint_iou");
    if (!is_without_contact) add(out.object_taps_rest, "object_taps");
  }
  out.is_initial_known = initial.has_value();
  for (std::vector<double>* values : {&out.object_taps_rest, &out.object_taps_all, &out.rmse, &out.iou})
    std::sort(values->begin(), values->end());
  return out;
}

Table table_of(const std::vector<SweepTableRow>& rows, const std::string& metric) {
  std::vector<double> medians;
  std::size_t longest = 0;
  bool any_iou = false;
  for (const SweepTableRow& row : rows) {
    if (!row.rmse.empty()) medians.push_back(row.median_rmse());
    longest = std::max(longest, row.name.size());
    any_iou = any_iou || !row.iou.empty();
  }
  const DisplayScale error = readable_scale(unit_of_column(metric), medians, 2);
  const DisplayScale share{"", 1.0, 2};
  const DisplayScale count{"", 1.0, 0};
  // Long names are moved to the end of the lines, so that the numbers fit on a screen.
  constexpr std::size_t kLongest = 32;
  Table table;
  for (const SweepTableRow& row : rows) {
    const int done = row.runs - row.failed;
    const auto part = [&](int jobs) { return done > 0 ? fmt::format("{:.1f}%", 100.0 * jobs / done) : "-"; };
    table.add_row();
    if (longest <= kLongest) table.show("group", row.name, Table::Kind::text);
    table.show("runs", std::to_string(row.runs));
    table.show("no contact", row.is_initial_known ? part(row.without_contact) : "-");
    table.show("found", part(row.found));
    table.show("failed", std::to_string(row.failed), Table::Kind::count);
    table.show("object taps, rest", spread(row.object_taps_rest, count));
    table.show("object taps, all", spread(row.object_taps_all, count));
    if (!medians.empty()) table.show(error.title(metric), spread(row.rmse, error));
    if (any_iou) table.show("footprint_iou", spread(row.iou, share));
    if (longest > kLongest) table.show("group", row.name, Table::Kind::text);
  }
  return table;
}

}  // namespace

std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, const InitialTaps& initial_taps) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  const std::vector<std::string> scenes = scene_keys(sweep);
  std::map<std::string, std::size_t> places;
  std::vector<SweepTableRow> rows;
  const std::string metric = main_error(results);
  for (const JobGroup& group : group_jobs(sweep, results, keys)) {
    SweepTableRow row = row_of(group, metric, initial_taps);
    if (row.runs == 0) continue;
    const Job& first = *group.jobs.front().job;
    row.scene = places.emplace(key_words(sweep, first, scenes, true), places.size()).first->second;
    row.name = key_words(sweep, first, keys, keys.size() > 1);
    // If only the seed varies, there is one group.
    if (row.name.empty()) row.name = keys.empty() ? "all jobs" : "(none)";
    rows.push_back(std::move(row));
  }
  if (rows.empty()) return {};
  std::stable_sort(rows.begin(), rows.end(), [](const SweepTableRow& a, const SweepTableRow& b) {
    return a.scene != b.scene ? a.scene < b.scene : a.median_rmse() < b.median_rmse();
  });
  std::string out = table_of(rows, metric).text();
  out += "no contact: runs without an initial tap on the object; rest: the other runs. Median (10 %-90 %).\n";
  const bool has_error = std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !row.rmse.empty(); });
  if (rows.size() < 2 || !has_error) return out;
  return out +
         fmt::format("Groups with the least {} come first{}.\n", metric, places.size() > 1 ? ", scene by scene" : "");
}

}  // namespace palpate
