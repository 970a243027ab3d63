// SPDX-License-Identifier: MIT
#include "analysis/column.hpp"
#include "analysis/gnuplot.hpp"
#include "analysis/groups.hpp"
#include "analysis/readable.hpp"
#include "analysis/statistics.hpp"
#include "config/layout.hpp"
#include "report/figures/figures.hpp"
#include "report/figures/sheet.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t kMostGroups = 24;
constexpr std::size_t kMostValues = 24;  ///< of a key, in a heat map
constexpr std::size_t kMostDots = 200;   ///< of a group
constexpr std::size_t kLongestName = 44;
constexpr const char* kOption = "--figures";

/// Jobs of which some ended well, under one name.
struct Group {
  std::string name;
  JobGroup jobs;
  std::size_t done = 0;
};

std::vector<Group> groups_of(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  std::vector<Group> groups;
  for (JobGroup& one : group_jobs(sweep, results, keys)) {
    const auto done = std::count_if(one.jobs.begin(), one.jobs.end(),
                                    [](const JobResult& job) { return job.row != nullptr && is_done(*job.row); });
    const std::string name = key_words(sweep, *one.jobs.front().job, keys, keys.size() > 1);
    if (done > 0) groups.push_back({name.empty() ? "all jobs" : name, std::move(one), static_cast<std::size_t>(done)});
  }
  return groups;
}

/// An axis for these values, with few enough tics for their numbers.
std::string value_axis(const std::vector<double>& values, double factor) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double spread = *most > *least ? (*most - *least) / factor : std::max(1e-9, std::abs(*most / factor));
  double low = *least / factor - 0.05 * spread;
  const double high = *most / factor + 0.05 * spread;
  if (*least >= 0.0) low = std::max(low, -0.02 * spread);
  return fmt::format("set xrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\n", low, high, tic_step(spread, 5.0));
}

/// A panel of lying boxes, a group a line, the first on top.
void draw_boxes(Sheet& sheet, const Box& box, const std::string& metric,
                const std::vector<std::vector<double>>& groups) {
  std::vector<double> all;
  for (const auto& values : groups) all.insert(all.end(), values.begin(), values.end());
  const Scale scale = readable_scale(unit_of_column(metric), all);
  std::string boxes;
  std::string dots;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::vector<double>& values = groups[g];
    if (values.empty()) continue;
    boxes += fmt::format("{}", g + 1);
    for (const double share : {0.1, 0.25, 0.5, 0.75, 0.9})
      boxes += fmt::format(" {:.10g}", quantile(values, share) / scale.factor);
    boxes += "\n";
    if (values.size() > kMostDots) continue;
    for (std::size_t i = 0; i < values.size(); ++i) {
      // Steps of the golden ratio: neighbours in value stand far from each other.
      const double shift = 0.5 * (std::fmod(0.6180339887 * static_cast<double>(i), 1.0) - 0.5);
      dots += fmt::format("{:.10g} {:.3f}\n", values[i] / scale.factor, static_cast<double>(g + 1) + shift);
    }
  }
  sheet.data("boxes_" + metric, boxes);
  sheet.data("jobs_" + metric, dots);
  std::string settings = "set border 1 lc rgb '#555555'\nset xtics nomirror out scale 0.5 font ',10'\nunset ytics\n";
  settings +=
      fmt::format("set yrange [{}:0.4]\nset grid x lc rgb '#e4e4e4' lt 1\n", static_cast<double>(groups.size()) + 0.6);
  settings += value_axis(all, scale.factor);
  settings += "set style fill transparent solid 0.35 noborder\n";
  const std::string better = find_column(metric, {metric}, kOption).better_words();
  settings += fmt::format("set xlabel {} font ',11' offset 0,0.3\n",
                          gnuplot_text(scale.title(metric) + (better.empty() ? "" : ", " + better)));
  const std::string block = "$boxes_" + metric;
  std::string clauses =
      fmt::format("plot {0} using 2:1:($6-$2):(0) with vectors nohead lw 1.5 lc rgb '#0072b2'", block);
  clauses += fmt::format(", \\\n  {0} using 4:1:3:5:($1-0.3):($1+0.3) with boxxyerror fc rgb '#0072b2'", block);
  if (!dots.empty())
    clauses += fmt::format(", \\\n  $jobs_{} using 1:2 with points pt 7 ps 0.45 lc rgb '#303030'", metric);
  clauses += fmt::format(", \\\n  {0} using 4:($1-0.3):(0):(0.6) with vectors nohead lw 3 lc rgb '#d55e00'", block);
  sheet.plot(box, settings, clauses);
}

Figure distributions_figure(const Sweep& sweep, const std::vector<Row>& results) {
  constexpr double kTop = 86;
  constexpr double kWidth = 250;
  std::vector<Group> groups = groups_of(sweep, results);
  const std::size_t left_out = groups.size() > kMostGroups ? groups.size() - kMostGroups : 0;
  groups.resize(groups.size() - left_out);
  std::size_t longest = 0;
  for (const Group& group : groups) longest = std::max(longest, std::min(group.name.size(), kLongestName));
  std::vector<std::string> metrics;
  for (const std::string& metric :
       {std::string("object_taps"), main_error(results), std::string("footprint_iou"), std::string("robot_seconds")}) {
    const bool present = std::any_of(groups.begin(), groups.end(),
                                     [&](const Group& one) { return !values_of(one.jobs, metric, kOption).empty(); });
    if (present) metrics.emplace_back(metric);
  }
  const bool tall =
      std::any_of(groups.begin(), groups.end(), [](const Group& one) { return one.name.size() > kLongestName; });
  const double line = tall ? 52 : 34;
  const double height = line * std::max(2.0, static_cast<double>(groups.size()));
  const double left = 46 + 8.0 * static_cast<double>(longest);
  const double bottom = kTop + height + 62;
  Sheet sheet(
      static_cast<int>(left + (kWidth + 40) * static_cast<double>(std::max<std::size_t>(metrics.size(), 2)) + 20),
      static_cast<int>(bottom + 44));
  sheet.text(sweep_name(sweep), 24, 14, 15);
  std::string words = "line: 10 % to 90 % of a group's jobs; box: the middle half; bar: median";
  const bool dots = std::any_of(groups.begin(), groups.end(), [](const Group& one) { return one.done <= kMostDots; });
  if (dots) words += "; dots: jobs";
  if (left_out > 0) words += fmt::format("; {} more groups are not shown, results.csv has them", left_out);
  sheet.text(words, 24, 42, 11);
  const double step = height / static_cast<double>(std::max<std::size_t>(groups.size(), 1));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::string> lines = wrapped(groups[g].name, kLongestName);
    if (lines.size() > 3) lines[2] += "...";
    lines.resize(std::min<std::size_t>(lines.size(), 3));
    const double middle = kTop + step * (static_cast<double>(g) + 0.5);
    sheet.text(fmt::format("{}", fmt::join(lines, "\n")), 24, middle - 8.8 * static_cast<double>(lines.size()), 11);
  }
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    std::vector<std::vector<double>> values;
    for (const Group& group : groups) values.push_back(values_of(group.jobs, metrics[m], kOption));
    draw_boxes(sheet, {left + (kWidth + 40) * static_cast<double>(m), kTop, kWidth, height}, metrics[m], values);
  }
  const auto done = std::count_if(results.begin(), results.end(), [](const Row& row) { return is_done(row); });
  sheet.text(fmt::format("{} jobs, {} of them done", sweep.jobs.size(), done), 24, bottom + 12, 10);
  return {"distributions", std::move(sheet)};
}

/// A swept key and its values, in the order of the sweep, as many as are shown.
struct Axis {
  std::string key;
  std::vector<std::string> values;
  bool cut = false;

  std::size_t place(const std::string& value) const {
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
  }
};

Axis axis_of(const Sweep& sweep, const std::string& key) {
  Axis axis{key, {}};
  for (const JobGroup& group : group_jobs(sweep, {}, {key})) axis.values.push_back(group.values.front());
  axis.cut = axis.values.size() > kMostValues;
  axis.values.resize(std::min(axis.values.size(), kMostValues));
  return axis;
}

/// gnuplot's list of tics: a value at each whole number.
std::string tics(const std::vector<std::string>& values) {
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i)
    out += fmt::format("{}{} {}", i > 0 ? ", " : "", gnuplot_text(values[i].empty() ? "(none)" : values[i]), i);
  return "(" + out + ")";
}

/// Of two swept keys but the seed that have two values or more; none where there are none.
std::optional<Figure> heat_map(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  if (keys.size() < 2) return {};
  const Axis y = axis_of(sweep, keys[0]);
  const Axis x = axis_of(sweep, keys[1]);
  const bool left_out = x.cut || y.cut;
  std::vector<std::vector<double>> cells(y.values.size(), std::vector<double>(x.values.size(), std::nan("")));
  std::vector<double> means;
  const std::string error = main_error(results);
  for (const JobGroup& group : group_jobs(sweep, results, {y.key, x.key})) {
    const std::size_t row = y.place(group.values[0]);
    const std::size_t column = x.place(group.values[1]);
    const std::vector<double> values = values_of(group, error, kOption);
    if (row == y.values.size() || column == x.values.size() || values.empty()) continue;
    means.push_back(mean_of(values));
    cells[row][column] = means.back();
  }
  if (means.empty()) return {};
  const Scale scale = readable_scale(Unit::metre, means);
  const auto [low, high] = std::minmax_element(means.begin(), means.end());
  const double least = *low / scale.factor;
  const double most = *high > *low ? *high / scale.factor : least + 1.0;
  std::string matrix;
  std::string numbers;
  for (std::size_t r = 0; r < cells.size(); ++r) {
    for (std::size_t c = 0; c < cells[r].size(); ++c) {
      const double mean = cells[r][c] / scale.factor;
      matrix += fmt::format("{}{}", c > 0 ? " " : "", std::isnan(mean) ? "NaN" : fmt::format("{:.10g}", mean));
      if (std::isnan(mean)) continue;
      const bool light = mean > least + 0.6 * (most - least);
      numbers += fmt::format("{} {} {} {}\n", c, r, scale.number(cells[r][c]), light ? 0 : 0xffffff);
    }
    matrix += "\n";
  }
  std::size_t longest_x = 0;
  std::size_t longest_y = 0;
  for (const std::string& value : x.values) longest_x = std::max(longest_x, value.size());
  for (const std::string& value : y.values) longest_y = std::max(longest_y, value.size());
  const double cell_width = 74;
  const double left = 70 + 7.4 * static_cast<double>(std::min<std::size_t>(longest_y, 40));
  const bool slanted = longest_x > 8;
  const double below = slanted ? 44 + 4.6 * static_cast<double>(std::min<std::size_t>(longest_x, 40)) : 56;
  const Box box{left, 96, std::max(220.0, cell_width * static_cast<double>(x.values.size())),
                std::max(120.0, 44 * static_cast<double>(y.values.size()))};
  Sheet sheet(static_cast<int>(std::max(560.0, box.left + box.width + 150)),
              static_cast<int>(box.top + box.height + below + 16));
  sheet.data("mean_" + error, matrix);
  sheet.data("numbers", numbers);
  const Colours colours{Palette::viridis, least, most, scale.title("mean " + error)};
  std::vector<std::string> over;
  if (std::find(sweep.keys.begin(), sweep.keys.end(), "seed") != sweep.keys.end()) over.emplace_back("seed");
  over.insert(over.end(), keys.begin() + 2, keys.end());
  std::string words = over.empty() ? error : fmt::format("{}, mean over {}", error, fmt::join(over, ", "));
  if (left_out) words += fmt::format("; the first {} values of a key", kMostValues);
  sheet.text(sweep_name(sweep), 24, 14, 15);
  sheet.text(words, 24, 42, 11);
  std::string settings = gnuplot_palette(colours.palette) +
                         fmt::format("set cbrange [{:.10g}:{:.10g}]\nunset colorbox\nset border lc rgb '#555555'\n",
                                     colours.low, colours.high);
  settings += fmt::format("set xrange [-0.5:{}]\nset yrange [{}:-0.5]\n", static_cast<double>(x.values.size()) - 0.5,
                          static_cast<double>(y.values.size()) - 0.5);
  settings += fmt::format("set xtics {} {} scale 0 font ',10'\nset ytics {} scale 0 font ',10'\n",
                          slanted ? "rotate by -35 left" : "norotate", tics(x.values), tics(y.values));
  settings += fmt::format("set label {} at screen {:.5f}, screen {:.5f} center font ',11'\n", gnuplot_text(x.key),
                          (box.left + 0.5 * box.width) / sheet.width(), 14.0 / sheet.height());
  sheet.text(y.key, 24, box.top - 24, 11);
  sheet.plot(box, settings,
             "plot $mean_" + error +
                 " matrix using 1:2:3 with image pixels, \\\n"
                 "  $numbers using 1:2:(strcol(3)):4 with labels font ',10' tc rgb variable");
  sheet.bar({box.left + box.width + 20, box.top, 14, box.height}, colours);
  return Figure{"heat_map", std::move(sheet)};
}

/// The error over the taps, by all keys that vary: none unless its values after each tap are kept.
std::optional<GroupCurves> kept_curves(const Sweep& sweep, const std::vector<Row>& results) {
  if (!TapSummaries::any_kept(sweep)) return std::nullopt;
  std::vector<TapValues> values(sweep.jobs.size());
  const std::string metric = main_error(results);
  const TapSummaries summaries(sweep, keep_values(values, {metric, kAgainstTaps}));
  if (!summaries.missing().empty() || !any_has(values, metric)) return std::nullopt;
  return make_group_curves(sweep, results, values, {curve_keys(sweep), metric, kAgainstTaps, nullptr});
}

}  // namespace

Figures write_sweep_figures(const Sweep& sweep, const std::filesystem::path& folder) {
  const std::vector<Row> results = sweep_results(sweep);
  if (std::none_of(results.begin(), results.end(), is_done))
    throw Error(sweep.directory.string(), "has no job that ended well", {}, Error::Kind::run);
  std::vector<Figure> figures{distributions_figure(sweep, results)};
  if (auto map = heat_map(sweep, results)) figures.push_back(std::move(*map));
  Figures out{write_gallery(folder, figures), {}};
  if (const auto curves = kept_curves(sweep, results)) {
    const std::filesystem::path file = folder / "curves.png";
    std::string note = write_curves_figure(*curves, sweep_name(sweep), kFigureWidth, file);
    out.pictures.push_back(file);
    if (!note.empty()) out.notes.push_back(std::move(note));
  }
  return out;
}

}  // namespace palpate
