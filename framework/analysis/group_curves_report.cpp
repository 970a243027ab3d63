// SPDX-License-Identifier: MIT
#include "analysis/group_curves_report.hpp"

#include "analysis/bootstrap.hpp"
#include "analysis/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace palpate {
namespace {

constexpr std::size_t kShownPlaces = 4;

/// Returns the least and the largest number of units over all points.
std::pair<std::size_t, std::size_t> units_at_points(const GroupCurves& curves) {
  std::pair<std::size_t, std::size_t> out{SIZE_MAX, 0};
  for (const GroupCurve& curve : curves.curves) {
    for (const CurvePoint& point : curve.points) {
      out.first = std::min(out.first, point.mean.clusters);
      out.second = std::max(out.second, point.mean.clusters);
    }
  }
  return out;
}

/// Returns the x values (taps or seconds) of up to four points, evenly spaced along the longest curve. The last one is
/// the end of the curve.
std::vector<double> shown_places(const GroupCurves& curves) {
  const auto longest =
      std::max_element(curves.curves.begin(), curves.curves.end(),
                       [](const GroupCurve& a, const GroupCurve& b) { return a.points.size() < b.points.size(); });
  const std::size_t count = longest->points.size();
  std::vector<double> out;
  for (std::size_t i = 1; i <= kShownPlaces; ++i) {
    const double at = longest->points[(count * i + kShownPlaces - 1) / kShownPlaces - 1].at;
    if (out.empty() || at > out.back()) out.push_back(at);
  }
  return out;
}

/// Returns the last point that is not after `at`. Returns null before the first point and after the last one.
const CurvePoint* point_at(const GroupCurve& curve, double at) {
  const CurvePoint* out = nullptr;
  for (const CurvePoint& point : curve.points) {
    if (point.at <= at) out = &point;
  }
  return !curve.points.empty() && curve.points.back().at < at ? nullptr : out;
}

}  // namespace

DisplayScale metric_scale(const GroupCurves& curves) {
  std::vector<double> means;
  for (const GroupCurve& curve : curves.curves) {
    for (const CurvePoint& point : curve.points) {
      if (point.mean.count > 0) means.push_back(point.mean.mean);
    }
  }
  return readable_scale(curves.metric.unit, means);
}

std::string curve_units_words(const GroupCurves& curves) {
  const auto [least, most] = units_at_points(curves);
  return units_words(least, most, curves.by_seed);
}

std::string curve_remarks(const GroupCurves& curves) {
  std::string out;
  for (const GroupCurve& curve : curves.curves) {
    const std::string scene = curve.scene_name();
    const std::string name = (scene.empty() ? "" : scene + ", ") + curve.name();
    const std::string lost = curve.counts.words(
        {ValueStatus::left_out, ValueStatus::failed, ValueStatus::unfinished, ValueStatus::without_value});
    if (!lost.empty()) out += fmt::format("{}: jobs in no point, of {}: {}\n", name, curve.counts.all(), lost);
    if (curve.points.empty()) continue;
    if (curve.ended > 0)
      out += fmt::format("{}: {} of {} jobs made fewer taps than others and count afterwards with their final values\n",
                         name, curve.ended, curve.counts.of(ValueStatus::counted));
    const auto fewer = [](const CurvePoint& a, const CurvePoint& b) { return a.mean.count < b.mean.count; };
    const auto [fewest, most] = std::minmax_element(curve.points.begin(), curve.points.end(), fewer);
    if (fewest->mean.count < most->mean.count)
      out += fmt::format("{}: {} to {} jobs have a value, depending on the point of the curve\n", name,
                         fewest->mean.count, most->mean.count);
  }
  return out + few_words(units_at_points(curves).first, curves.by_seed, kLeastForInterval);
}

std::string curves_table(const GroupCurves& curves) {
  const DisplayScale scale = metric_scale(curves);
  const std::vector<double> places = shown_places(curves);
  const DisplayScale axis = readable_scale(curves.against.unit, places);
  const bool many_scenes = curves.scene_names().size() > 1;
  const std::string better = curves.metric.better_words();
  std::string out = fmt::format("{} against {}{}\n", scale.title(curves.metric.name), axis.title(curves.against.name),
                                better.empty() ? "" : "; " + better);
  const bool taps = curves.against.name == kAgainstTaps;
  Table table;
  for (const GroupCurve& curve : curves.curves) {
    table.add_row();
    if (many_scenes)
      table.show(fmt::format("{}", fmt::join(curves.scenes, ", ")), curve.scene_name(), Table::Kind::text);
    table.show(curves.by.empty() ? "group" : fmt::format("{}", fmt::join(curves.by, ", ")), curve.name(),
               Table::Kind::text);
    table.show("jobs", std::to_string(curve.counts.all()));
    for (const double at : places) {
      const CurvePoint* const point = point_at(curve, at);
      table.show(taps ? fmt::format("{:.0f} taps", at) : axis.with_unit(axis.number(at)),
                 point != nullptr ? scale.estimate(point->mean) : "-");
    }
  }
  out += table.text();
  out += fmt::format(
      "mean [95 % interval] over {}, as in 'palpate compare'; a job that has ended counts with its final value\n",
      curve_units_words(curves));
  return out + curve_remarks(curves);
}

std::vector<Row> curves_rows(const GroupCurves& curves) {
  std::vector<Row> rows;
  const bool taps = curves.against.name == kAgainstTaps;
  for (const GroupCurve& curve : curves.curves) {
    for (const CurvePoint& point : curve.points) {
      Row row;
      const auto add_keys = [&](const std::vector<std::string>& keys, const std::vector<std::string>& values) {
        for (std::size_t i = 0; i < keys.size(); ++i)
          row.add(keys[i], values[i].empty() ? Scalar() : Scalar(values[i]));
      };
      row.add("metric", curves.metric.name);
      row.add("against", curves.against.name);
      add_keys(curves.scenes, curve.scene);
      add_keys(curves.by, curve.values);
      row.add("at", taps ? Scalar(static_cast<std::int64_t>(point.at)) : Scalar(point.at));
      row.add("n", static_cast<std::int64_t>(point.mean.count));
      row.add("units", static_cast<std::int64_t>(point.mean.clusters));
      add_mean(row, "", point.mean);
      add_counts(row, curve.counts, true);
      row.add("ended", curve.ended);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace palpate
