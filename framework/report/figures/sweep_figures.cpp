// SPDX-License-Identifier: MIT
#include "analysis/column.hpp"
#include "analysis/gnuplot.hpp"
#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "config/text_layout.hpp"
#include "report/figures/figure_layout.hpp"
#include "report/figures/figures.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t kMostGroups = 24;
constexpr std::size_t kMostValues = 24;  ///< largest number of values per key of a heat map
constexpr std::size_t kMostDots = 200;   ///< largest number of dots per group
constexpr std::size_t kLongestName = 44;
constexpr const char* kOption = "--figures";

/// A named group of jobs, of which at least one ended without a failure.
struct NamedJobGroup {
  std::string name;
  JobGroup jobs;
  std::size_t done = 0;
};

std::vector<NamedJobGroup> groups_of(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  std::vector<NamedJobGroup> groups;
  for (JobGroup& one : group_jobs(sweep, results, keys)) {
    const auto done = std::count_if(one.jobs.begin(), one.jobs.end(),
                                    [](const JobResult& job) { return job.row != nullptr && is_done(*job.row); });
    const std::string name = key_words(sweep, *one.jobs.front().job, keys, keys.size() > 1);
    if (done > 0) groups.push_back({name.empty() ? "all jobs" : name, std::move(one), static_cast<std::size_t>(done)});
  }
  return groups;
}

/// Returns the gnuplot commands of an axis for these values. The axis has few enough tics that their numbers do not
/// overlap.
std::string value_axis(const std::vector<double>& values, double factor) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double spread = *most > *least ? (*most - *least) / factor : std::max(1e-9, std::abs(*most / factor));
  double low = *least / factor - 0.05 * spread;
  const double high = *most / factor + 0.05 * spread;
  if (*least >= 0.0) low = std::max(low, -0.02 * spread);
  return fmt::format("set xrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\n", low, high, tic_step(spread, 5.0));
}

/// Draws a panel of horizontal box plots, one line per group, with the first group at the top. A box plot shows the 10,
/// 25, 50, 75 and 90 % quantiles, and dots show the jobs.
void draw_boxes(FigureLayout& layout, const Box& box, const std::string& metric,
                const std::vector<std::vector<double>>& groups) {
  std::vector<double> all;
  for (const auto& values : groups) all.insert(all.end(), values.begin(), values.end());
  const DisplayScale scale = readable_scale(unit_of_column(metric), all);
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
      // Shifts the dots by steps of the golden ratio, which separates dots with similar values.
      const double shift = 0.5 * (std::fmod(0.6180339887 * static_cast<double>(i), 1.0) - 0.5);
      dots += fmt::format("{:.10g} {:.3f}\n", values[i] / scale.factor, static_cast<double>(g + 1) + shift);
    }
  }
  layout.data("boxes_" + metric, boxes);
  layout.data("jobs_" + metric, dots);
  const std::string better = find_column(metric, {metric}, kOption).better_words();
  const std::string title = scale.title(metric) + (better.empty() ? "" : ", " + better);
  const std::string settings = fill_template("boxes", static_cast<double>(groups.size()) + 0.6,
                                             value_axis(all, scale.factor), gnuplot_text(title));
  const std::string block = "$boxes_" + metric;
  std::string clauses =
      fmt::format("plot {0} using 2:1:($6-$2):(0) with vectors nohead lw 1.5 lc rgb '#0072b2'", block);
  clauses += fmt::format(", \\\n  {0} using 4:1:3:5:($1-0.3):($1+0.3) with boxxyerror fc rgb '#0072b2'", block);
  if (!dots.empty())
    clauses += fmt::format(", \\\n  $jobs_{} using 1:2 with points pt 7 ps 0.45 lc rgb '#303030'", metric);
  clauses += fmt::format(", \\\n  {0} using 4:($1-0.3):(0):(0.6) with vectors nohead lw 3 lc rgb '#d55e00'", block);
  layout.plot(box, settings, clauses);
}

/// Returns the metrics of the figure for which at least one job has a value.
std::vector<std::string> drawn_metrics(const std::vector<NamedJobGroup>& groups, const std::vector<Row>& results) {
  std::vector<std::string> out{"object_taps", main_error(results), "footprint_iou", "robot_seconds"};
  const auto is_absent = [&](const std::string& metric) {
    return std::all_of(groups.begin(), groups.end(),
                       [&](const NamedJobGroup& one) { return values_of(one.jobs, metric, kOption).empty(); });
  };
  out.erase(std::remove_if(out.begin(), out.end(), is_absent), out.end());
  return out;
}

/// Writes the names of the groups in at most three lines each. The first name is at `top`; `step` is the distance
/// between names.
void write_names(FigureLayout& layout, const std::vector<NamedJobGroup>& groups, double top, double step) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::string> lines = wrapped(groups[g].name, kLongestName);
    if (lines.size() > 3) lines[2] += "...";
    lines.resize(std::min<std::size_t>(lines.size(), 3));
    const double middle = top + step * (static_cast<double>(g) + 0.5);
    layout.text(fmt::format("{}", fmt::join(lines, "\n")), 24, middle - 8.8 * static_cast<double>(lines.size()), 11);
  }
}

Figure distributions_figure(const Sweep& sweep, const std::vector<Row>& results) {
  constexpr double kTop = 86;
  constexpr double kWidth = 250;
  std::vector<NamedJobGroup> groups = groups_of(sweep, results);
  const std::size_t left_out = groups.size() > kMostGroups ? groups.size() - kMostGroups : 0;
  groups.resize(groups.size() - left_out);
  std::size_t longest = 0;
  for (const NamedJobGroup& group : groups) longest = std::max(longest, group.name.size());
  const std::vector<std::string> metrics = drawn_metrics(groups, results);
  const double height = (longest > kLongestName ? 52 : 34) * std::max(2.0, static_cast<double>(groups.size()));
  const double left = 46 + 8.0 * static_cast<double>(std::min(longest, kLongestName));
  const double bottom = kTop + height + 62;
  FigureLayout layout(
      static_cast<int>(left + (kWidth + 40) * static_cast<double>(std::max<std::size_t>(metrics.size(), 2)) + 20),
      static_cast<int>(bottom + 44));
  layout.text(sweep_name(sweep), 24, 14, 15);
  std::string words = "line: 10 % to 90 % of a group's jobs; box: the middle half; bar: median";
  const bool dots =
      std::any_of(groups.begin(), groups.end(), [](const NamedJobGroup& one) { return one.done <= kMostDots; });
  if (dots) words += "; dots: jobs";
  if (left_out > 0) words += fmt::format("; {} more groups are not shown, results.csv has them", left_out);
  layout.text(words, 24, 42, 11);
  write_names(layout, groups, kTop, height / static_cast<double>(std::max<std::size_t>(groups.size(), 1)));
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    std::vector<std::vector<double>> values;
    for (const NamedJobGroup& group : groups) values.push_back(values_of(group.jobs, metrics[m], kOption));
    draw_boxes(layout, {left + (kWidth + 40) * static_cast<double>(m), kTop, kWidth, height}, metrics[m], values);
  }
  const auto done = std::count_if(results.begin(), results.end(), [](const Row& row) { return is_done(row); });
  layout.text(fmt::format("{} jobs, {} of them done", sweep.jobs.size(), done), 24, bottom + 12, 10);
  return {"distributions", std::move(layout)};
}

/// A swept key and its shown values, in the order of the sweep.
struct HeatMapAxis {
  std::string key;
  std::vector<std::string> values;
  bool cut = false;

  std::size_t place(const std::string& value) const {
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
  }
};

HeatMapAxis axis_of(const Sweep& sweep, const std::string& key) {
  HeatMapAxis axis{key, {}};
  for (const JobGroup& group : group_jobs(sweep, {}, {key})) axis.values.push_back(group.values.front());
  axis.cut = axis.values.size() > kMostValues;
  axis.values.resize(std::min(axis.values.size(), kMostValues));
  return axis;
}

/// Returns gnuplot's list of tics, with the values as labels at 0, 1, 2 and so on.
std::string tics(const std::vector<std::string>& values) {
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i)
    out += fmt::format("{}{} {}", i > 0 ? ", " : "", gnuplot_text(values[i].empty() ? "(none)" : values[i]), i);
  return "(" + out + ")";
}

/// Mean errors by the values of two keys; NaN where no job has a value.
struct HeatMap {
  HeatMapAxis x;
  HeatMapAxis y;
  std::string error;
  std::vector<std::vector<double>> cells;  ///< one row per value of the key on the y axis
  std::vector<double> means;               ///< values of all cells with a value
};

HeatMap heat_map_of(const Sweep& sweep, const std::vector<Row>& results, const std::vector<std::string>& keys) {
  HeatMap out{axis_of(sweep, keys[1]), axis_of(sweep, keys[0]), main_error(results), {}, {}};
  out.cells.assign(out.y.values.size(), std::vector<double>(out.x.values.size(), std::nan("")));
  for (const JobGroup& group : group_jobs(sweep, results, {out.y.key, out.x.key})) {
    const std::size_t row = out.y.place(group.values[0]);
    const std::size_t column = out.x.place(group.values[1]);
    const std::vector<double> values = values_of(group, out.error, kOption);
    if (row == out.y.values.size() || column == out.x.values.size() || values.empty()) continue;
    out.means.push_back(mean_of(values));
    out.cells[row][column] = out.means.back();
  }
  return out;
}

/// Adds data blocks with the cells as a matrix, and with the numbers to print in the cells. Numbers are black on light
/// colours and white on dark colours.
void add_cells(FigureLayout& layout, const HeatMap& map, const DisplayScale& scale, const ColourScale& colours) {
  std::string matrix;
  std::string numbers;
  for (std::size_t r = 0; r < map.cells.size(); ++r) {
    for (std::size_t c = 0; c < map.cells[r].size(); ++c) {
      const double mean = map.cells[r][c] / scale.factor;
      matrix += fmt::format("{}{}", c > 0 ? " " : "", std::isnan(mean) ? "NaN" : fmt::format("{:.10g}", mean));
      if (std::isnan(mean)) continue;
      const bool light = mean > colours.low + 0.6 * (colours.high - colours.low);
      numbers += fmt::format("{} {} {} {}\n", c, r, scale.number(map.cells[r][c]), light ? 0 : 0xffffff);
    }
    matrix += "\n";
  }
  layout.data("mean_" + map.error, matrix);
  layout.data("numbers", numbers);
}

/// Returns the title of the heat map: "rmse_m, mean over seed, taps; the first 24 values of a key".
std::string heat_map_words(const Sweep& sweep, const HeatMap& map, const std::vector<std::string>& keys) {
  std::vector<std::string> over;
  if (std::find(sweep.keys.begin(), sweep.keys.end(), "seed") != sweep.keys.end()) over.emplace_back("seed");
  over.insert(over.end(), keys.begin() + 2, keys.end());
  std::string out = over.empty() ? map.error : fmt::format("{}, mean over {}", map.error, fmt::join(over, ", "));
  return out + (map.x.cut || map.y.cut ? fmt::format("; the first {} values of a key", kMostValues) : "");
}

std::size_t longest_of(const std::vector<std::string>& values) {
  std::size_t out = 0;
  for (const std::string& value : values) out = std::max(out, value.size());
  return out;
}

/// Draws the mean error by the values of two keys: the first two swept keys with several values, except the seed.
/// Returns nullopt if there are fewer than two such keys.
std::optional<Figure> heat_map(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  if (keys.size() < 2) return {};
  const HeatMap map = heat_map_of(sweep, results, keys);
  if (map.means.empty()) return {};
  const DisplayScale scale = readable_scale(Unit::metre, map.means);
  const auto [low, high] = std::minmax_element(map.means.begin(), map.means.end());
  const double least = *low / scale.factor;
  const double most = *high > *low ? *high / scale.factor : least + 1.0;
  const ColourScale colours{Palette::viridis, least, most, scale.title("mean " + map.error)};
  constexpr std::size_t kLongestValue = 40;
  constexpr double kCellWidth = 74;
  const std::size_t longest_x = longest_of(map.x.values);
  const bool slanted = longest_x > 8;
  const double below = slanted ? 44 + 4.6 * static_cast<double>(std::min(longest_x, kLongestValue)) : 56;
  const Box box{70 + 7.4 * static_cast<double>(std::min(longest_of(map.y.values), kLongestValue)), 96,
                std::max(220.0, kCellWidth * static_cast<double>(map.x.values.size())),
                std::max(120.0, 44 * static_cast<double>(map.y.values.size()))};
  FigureLayout layout(static_cast<int>(std::max(560.0, box.left + box.width + 150)),
                      static_cast<int>(box.top + box.height + below + 16));
  add_cells(layout, map, scale, colours);
  layout.text(sweep_name(sweep), 24, 14, 15);
  layout.text(heat_map_words(sweep, map, keys), 24, 42, 11);
  layout.text(map.y.key, 24, box.top - 24, 11);
  const std::string settings =
      fill_template("heat_map", least, most, static_cast<double>(map.x.values.size()) - 0.5,
                    static_cast<double>(map.y.values.size()) - 0.5, slanted ? "rotate by -35 left" : "norotate",
                    tics(map.x.values), tics(map.y.values), gnuplot_text(map.x.key),
                    (box.left + 0.5 * box.width) / layout.width(), 14.0 / layout.height());
  layout.plot(box, gnuplot_palette(colours.palette) + settings,
              "plot $mean_" + map.error +
                  " matrix using 1:2:3 with image pixels, \\\n"
                  "  $numbers using 1:2:(strcol(3)):4 with labels font ',10' tc rgb variable");
  layout.bar({box.left + box.width + 20, box.top, 14, box.height}, colours);
  return Figure{"heat_map", std::move(layout)};
}

/// Returns curves of the error against the taps. Jobs with equal values of the keys that curve_keys() returns form a
/// group. Returns nullopt unless the values after each tap are stored.
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
  Figures out{write_figures(folder, figures), {}};
  if (const auto curves = kept_curves(sweep, results)) {
    const std::filesystem::path file = folder / "curves.png";
    std::string note = write_curves_figure(*curves, sweep_name(sweep), kFigureWidth, file);
    out.pictures.push_back(file);
    if (!note.empty()) out.notes.push_back(std::move(note));
  }
  return out;
}

}  // namespace palpate
