// SPDX-License-Identifier: MIT
#include "analysis/column.hpp"
#include "analysis/gnuplot.hpp"
#include "analysis/groups.hpp"
#include "analysis/readable.hpp"
#include "analysis/statistics.hpp"
#include "report/figures/gallery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t kMostGroups = 24;
constexpr std::size_t kMostValues = 24;  ///< of a key, in a heat map
constexpr std::size_t kMostDots = 200;   ///< of a group

/// Jobs that ended well, under one name.
struct Group {
  std::string name;
  std::vector<const Row*> rows;
};

std::vector<Group> groups_of(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  std::vector<Group> groups;
  for (const JobGroup& one : group_jobs(sweep, results, keys)) {
    Group group{key_words(keys, one.values, keys.size() > 1), {}};
    if (group.name.empty()) group.name = "all jobs";
    for (const JobResult& job : one.jobs) {
      if (job.row != nullptr && is_done(*job.row)) group.rows.push_back(job.row);
    }
    if (!group.rows.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

/// The name in at most three lines, broken behind commas where it can be.
std::string wrapped(const std::string& name, std::size_t longest) {
  std::string out;
  std::size_t begin = 0;
  for (int line = 0; begin < name.size(); ++line) {
    std::size_t end = name.size();
    if (end - begin > longest) {
      const auto comma = name.rfind(", ", begin + longest - 2);
      end = comma != std::string::npos && comma > begin ? comma + 2 : begin + longest;
    }
    const bool cut = line == 2 && end < name.size();
    out += (line > 0 ? "\n" : "") + name.substr(begin, end - begin) + (cut ? "..." : "");
    if (cut) break;
    begin = end;
  }
  return out;
}

std::vector<double> values_of(const Group& group, const std::string& metric) {
  std::vector<double> out;
  for (const Row* row : group.rows) {
    if (const auto value = number_in(*row, metric, "--figures"); value && std::isfinite(*value)) out.push_back(*value);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string seeds_words(const Sweep& sweep) { return fmt::format("{} jobs", sweep.jobs.size()); }

/// An axis for these values, with few enough tics for their numbers.
std::string value_axis(const std::vector<double>& values, double factor) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double spread = *most > *least ? (*most - *least) / factor : std::max(1e-9, std::abs(*most / factor));
  double low = *least / factor - 0.05 * spread;
  const double high = *most / factor + 0.05 * spread;
  if (*least >= 0.0) low = std::max(low, -0.02 * spread);
  const double power = std::pow(10.0, std::floor(std::log10(spread / 5.0)));
  const double coarse = spread / 5.0 / power;
  const double step = power * (coarse > 5.0 ? 10.0 : coarse > 2.0 ? 5.0 : coarse > 1.0 ? 2.0 : 1.0);
  return fmt::format("set xrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\n", low, high, step);
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
  const Column column = find_column(metric, {metric}, "--figures");
  settings +=
      fmt::format("set xlabel {} font ',11' offset 0,0.3\n",
                  gnuplot_text(scale.title(metric) + (column.better == RecordField::Better::more   ? ", more is better"
                                                      : column.better == RecordField::Better::less ? ", less is better"
                                                                                                   : "")));
  const std::string block = "$boxes_" + metric;
  std::string clauses =
      fmt::format("plot {0} using 2:1:($6-$2):(0) with vectors nohead lw 1.5 lc rgb '#0072b2'", block);
  clauses += fmt::format(", \\\n  {0} using 4:1:3:5:($1-0.3):($1+0.3) with boxxyerror fc rgb '#0072b2'", block);
  if (!dots.empty())
    clauses += fmt::format(", \\\n  $jobs_{} using 1:2 with points pt 7 ps 0.45 lc rgb '#303030'", metric);
  clauses += fmt::format(", \\\n  {0} using 4:($1-0.3):(0):(0.6) with vectors nohead lw 3 lc rgb '#d55e00'", block);
  sheet.plot(box, settings, clauses);
}

}  // namespace

Figure distributions_figure(const Sweep& sweep, const std::vector<Row>& results) {
  constexpr double kTop = 86;
  constexpr double kWidth = 250;
  std::vector<Group> groups = groups_of(sweep, results);
  const std::size_t left_out = groups.size() > kMostGroups ? groups.size() - kMostGroups : 0;
  groups.resize(groups.size() - left_out);
  std::size_t longest = 0;
  for (const Group& group : groups) longest = std::max(longest, std::min<std::size_t>(group.name.size(), 44));
  std::vector<std::string> metrics;
  for (const std::string& metric :
       {std::string("on_surface_taps"), main_error(), std::string("footprint_iou"), std::string("robot_seconds")}) {
    const bool present =
        std::any_of(groups.begin(), groups.end(), [&](const Group& one) { return !values_of(one, metric).empty(); });
    if (present) metrics.emplace_back(metric);
  }
  const bool tall = std::any_of(groups.begin(), groups.end(), [](const Group& one) { return one.name.size() > 44; });
  const double line = tall ? 52 : 34;
  const double height = line * std::max(2.0, static_cast<double>(groups.size()));
  const double left = 46 + 8.0 * static_cast<double>(longest);
  const double bottom = kTop + height + 62;
  Sheet sheet(
      static_cast<int>(left + (kWidth + 40) * static_cast<double>(std::max<std::size_t>(metrics.size(), 2)) + 20),
      static_cast<int>(bottom + 44));
  sheet.text(sweep_name(sweep), 24, 14, 15);
  std::string words = "line: 10 % to 90 % of a group's jobs; box: the middle half; bar: median";
  const bool dots =
      std::any_of(groups.begin(), groups.end(), [](const Group& one) { return one.rows.size() <= kMostDots; });
  if (dots) words += "; dots: jobs";
  if (left_out > 0) words += fmt::format("; {} more groups are not shown, results.csv has them", left_out);
  sheet.text(words, 24, 42, 11);
  const double step = height / static_cast<double>(std::max<std::size_t>(groups.size(), 1));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::string name = wrapped(groups[g].name, 44);
    const auto lines = 1 + std::count(name.begin(), name.end(), '\n');
    const double middle = kTop + step * (static_cast<double>(g) + 0.5);
    sheet.text(name, 24, middle - 8.8 * static_cast<double>(lines), 11);
  }
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    std::vector<std::vector<double>> values;
    for (const Group& group : groups) values.push_back(values_of(group, metrics[m]));
    draw_boxes(sheet, {left + (kWidth + 40) * static_cast<double>(m), kTop, kWidth, height}, metrics[m], values);
  }
  const auto done = std::count_if(results.begin(), results.end(), [](const Row& row) { return is_done(row); });
  sheet.text(fmt::format("{}, {} of them done", seeds_words(sweep), done), 24, bottom + 12, 10);
  return {"distributions", std::move(sheet)};
}

namespace {

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

}  // namespace

std::vector<Figure> heat_maps(const Sweep& sweep, const std::vector<Row>& results) {
  const std::vector<std::string> keys = varying_keys(sweep, setting_keys(sweep));
  if (keys.size() < 2) return {};
  const Axis y = axis_of(sweep, keys[0]);
  const Axis x = axis_of(sweep, keys[1]);
  const bool left_out = x.cut || y.cut;
  std::vector<std::vector<std::vector<double>>> cells(y.values.size(),
                                                      std::vector<std::vector<double>>(x.values.size()));
  for (const JobGroup& group : group_jobs(sweep, results, {y.key, x.key})) {
    const std::size_t row = y.place(group.values[0]);
    const std::size_t column = x.place(group.values[1]);
    if (row == y.values.size() || column == x.values.size()) continue;
    for (const JobResult& job : group.jobs) {
      if (job.row == nullptr || !is_done(*job.row)) continue;
      if (const auto value = number_in(*job.row, main_error(), "--figures")) cells[row][column].push_back(*value);
    }
  }
  std::vector<double> means;
  for (const auto& line : cells) {
    for (const auto& cell : line) {
      if (!cell.empty()) means.push_back(estimate_mean(cell).mean);
    }
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
      const bool empty = cells[r][c].empty();
      const double mean = empty ? 0.0 : estimate_mean(cells[r][c]).mean;
      matrix += fmt::format("{}{}", c > 0 ? " " : "", empty ? "NaN" : fmt::format("{:.10g}", mean / scale.factor));
      if (empty) continue;
      const bool light = mean / scale.factor > least + 0.6 * (most - least);
      numbers += fmt::format("{} {} {} {}\n", c, r, scale.number(mean), light ? 0 : 0xffffff);
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
  sheet.data("mean_" + main_error(), matrix);
  sheet.data("numbers", numbers);
  const Colours colours{Palette::viridis, least, most, scale.title("mean " + main_error())};
  std::vector<std::string> over;
  if (std::find(sweep.keys.begin(), sweep.keys.end(), "seed") != sweep.keys.end()) over.emplace_back("seed");
  over.insert(over.end(), keys.begin() + 2, keys.end());
  std::string words =
      over.empty() ? main_error() : fmt::format("{}, mean over {}", main_error(), fmt::join(over, ", "));
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
             "plot $mean_" + main_error() +
                 " matrix using 1:2:3 with image pixels, \\\n"
                 "  $numbers using 1:2:(strcol(3)):4 with labels font ',10' tc rgb variable");
  sheet.bar({box.left + box.width + 20, box.top, 14, box.height}, colours);
  std::vector<Figure> out;
  out.push_back({"heat_map", std::move(sheet)});
  return out;
}

}  // namespace palpate
