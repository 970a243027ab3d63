// SPDX-License-Identifier: MIT
#include "analysis/pareto_report.hpp"

#include "analysis/gnuplot.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

using Field = MeanEstimate Setting::*;

DisplayScale scale_of(const Pareto& pareto, const Column& key, Field field) {
  std::vector<double> means;
  for (const Setting& setting : pareto.settings) {
    if ((setting.*field).count > 0) means.push_back((setting.*field).mean);
  }
  return readable_scale(key.unit, means);
}

/// Returns the smallest and the largest number of units of statistics (StatisticalUnits) among the settings with cost
/// and error.
std::pair<std::size_t, std::size_t> seeds_of(const Pareto& pareto) {
  std::size_t fewest = kEnoughUnits;
  std::size_t most = 0;
  for (const Setting& one : pareto.settings) {
    if (one.error.clusters == 0) continue;
    fewest = most == 0 ? one.error.clusters : std::min(fewest, one.error.clusters);
    most = std::max(most, one.error.clusters);
  }
  return {fewest, most};
}

std::string cost_text(const Setting& setting, const DisplayScale& scale) {
  const MeanEstimate& cost = setting.cost;
  if (cost.count == 0) return "-";
  const std::string half = cost.interval ? scale.number((cost.interval->high - cost.interval->low) / 2) : "-";
  return fmt::format("{} +- {}", scale.number(cost.mean), half);
}

/// An axis, with its range in the unit of the axis.
struct PlotAxis {
  DisplayScale scale;
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;

  /// Returns "mean low high". On a logarithmic axis, an end of the interval that is below the axis is moved to the
  /// lower end of the axis, because the logarithm needs positive numbers.
  std::string columns(const MeanEstimate& estimate) const {
    const MeanInterval ends = interval_or_mean(estimate);
    const auto clipped = [&](double value) { return logarithmic ? std::max(value, low) : value; };
    return fmt::format("{} {} {}", estimate.mean / scale.factor, clipped(ends.low / scale.factor),
                       clipped(ends.high / scale.factor));
  }

  static MeanInterval interval_or_mean(const MeanEstimate& estimate) {
    return estimate.interval.value_or(MeanInterval{estimate.mean, estimate.mean});
  }
};

PlotAxis plot_axis(const Pareto& pareto, const Column& key, Field field, const std::optional<double>& line) {
  constexpr double kLogarithmicFrom = 20.0;
  PlotAxis axis;
  axis.scale = scale_of(pareto, key, field);
  std::vector<double> means;
  std::vector<double> ends;
  for (const Setting& one : pareto.settings) {
    const MeanEstimate& estimate = one.*field;
    if (estimate.count == 0) continue;
    means.push_back(estimate.mean / axis.scale.factor);
    for (const double end : {PlotAxis::interval_or_mean(estimate).low, PlotAxis::interval_or_mean(estimate).high})
      ends.push_back(end / axis.scale.factor);
  }
  if (line) ends.push_back(*line / axis.scale.factor);
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  const auto [low, high] = std::minmax_element(ends.begin(), ends.end());
  axis.logarithmic = *least > 0.0 && *most / *least > kLogarithmicFrom && (!line || *line > 0.0);
  if (axis.logarithmic) {
    const double bottom = std::max(*low, *least / 4);
    const double margin = std::pow(*high / bottom, 0.06);
    axis.low = bottom / margin;
    axis.high = *high * margin;
  } else {
    const double margin = *high > *low ? 0.06 * (*high - *low) : std::max(0.1 * std::abs(*high), 1e-12);
    axis.low = *low - margin;
    axis.high = *high + margin;
  }
  return axis;
}

constexpr double kKeyLeft = 0.635;  // left edge of the legend, as a share of the picture's width

/// Colours of the fronts, one per scene.
constexpr std::array<const char*, 5> kFrontColours{"#0b5394", "#00795a", "#7a3e9d", "#8c6d46", "#404040"};
constexpr const char* kChosenColour = "#c1440e";

const char* front_colour(const Setting& setting) { return kFrontColours[setting.scene % kFrontColours.size()]; }

/// Returns the plot clauses for the legend: number and name of each setting on the front and of the chosen setting.
std::vector<std::string> named_settings(const Pareto& pareto, const Setting* chosen) {
  constexpr std::size_t kLongest = 48;  // number of letters that fit next to the plot
  constexpr std::size_t kMostLines = 26;
  std::vector<std::string> out;
  int left_out = 0;
  for (const Setting& one : pareto.settings) {
    if (one.front == 0 && &one != chosen) continue;
    const std::string number = one.front > 0 ? fmt::format("{}: ", one.front) : "";
    std::vector<std::string> lines = wrapped(number + one.name, kLongest);
    if (out.size() + lines.size() > kMostLines && &one != chosen) {
      ++left_out;
      continue;
    }
    for (std::string& line : lines) {
      if (line.size() > kLongest) line.replace(kLongest - 3, std::string::npos, "...");
      const char* const mark = &line == &lines.front() ? "pt 7 ps 2" : "pt 7 ps 0";
      out.push_back(fmt::format("keyentry with points {} lc rgb '{}' title {}", mark,
                                &one == chosen ? kChosenColour : front_colour(one), gnuplot_text(line)));
    }
  }
  if (left_out > 0)
    out.push_back(fmt::format("keyentry with points ps 0 title 'and {} more, see the table'", left_out));
  return out;
}

}  // namespace

std::string seeds_words(const Pareto& pareto) {
  const auto [fewest, most] = seeds_of(pareto);
  return units_words(fewest, most, pareto.by_seed);
}

static Table settings_table(const Pareto& pareto) {
  const DisplayScale cost = scale_of(pareto, pareto.cost, &Setting::cost);
  const DisplayScale error = scale_of(pareto, pareto.error, &Setting::error);
  Table table;
  for (const Setting& one : pareto.settings) {
    const std::string jobs = std::to_string(one.counts.all());
    table.add_row();
    table.show("front", one.front > 0 ? std::to_string(one.front) : "");
    table.store("front", one.front > 0 ? std::optional(one.front) : std::nullopt);
    table.show("setting", one.name, Table::Kind::text);
    for (std::size_t i = 0; i < pareto.keys.size(); ++i) table.store(pareto.keys[i], one.values[i]);
    table.show("jobs", jobs);
    add_counts(table.last_row(), one.counts);
    table.store("seeds", pareto.by_seed ? std::optional(static_cast<std::int64_t>(one.error.clusters)) : std::nullopt);
    table.show(cost.title(pareto.cost.name), cost_text(one, cost));
    add_mean(table.last_row(), pareto.cost.name + ".", one.cost);
    table.show(error.title(pareto.error.name), error.estimate(one.error));
    add_mean(table.last_row(), pareto.error.name + ".", one.error);
    table.show(
        "", one.counts.words({ValueStatus::failed, ValueStatus::unfinished, ValueStatus::without_value}, " of " + jobs),
        Table::Kind::text);
  }
  return table;
}

std::string pareto_table(const Pareto& pareto) {
  std::string out = settings_table(pareto).text();
  out += fmt::format(
      "{}, with its 95 % interval (Student's t); {} of {} is better\nnumbered settings form the front: no other "
      "setting is at least as good in both values and better in one\n",
      pareto.by_seed ? fmt::format("mean over {}", seeds_words(pareto)) : "the seed is not swept: mean over jobs",
      pareto.more_is_better() ? "more" : "less", pareto.error.name);
  if (pareto.scenes.size() > 1) out += fmt::format("{} scenes, each with its own front\n", pareto.scenes.size());
  out += few_words(seeds_of(pareto).first, pareto.by_seed, 2);
  bool equal = false;
  for (const Setting& one : pareto.settings) {
    if (!pareto.by_seed && one.error.clusters < one.error.count)
      out += copies_words(one.name, one.error.count, one.error.clusters);
    equal = equal || (one.error.clusters > 1 && !one.error.interval) || (one.cost.clusters > 1 && !one.cost.interval);
  }
  if (equal)
    out += fmt::format("a setting with equal values for all {} has no interval: the values show no spread\n",
                       pareto.by_seed ? "seeds" : "jobs");
  const bool all_complete =
      std::all_of(pareto.settings.begin(), pareto.settings.end(), [](const Setting& one) { return one.complete(); });
  if (!all_complete) out += "settings with jobs that failed, are missing or have no value are not compared\n";
  return out;
}

std::vector<Row> pareto_rows(const Pareto& pareto) { return settings_table(pareto).rows(); }

std::string error_words(const Pareto& pareto, const Setting& setting) {
  const DisplayScale scale = scale_of(pareto, pareto.error, &Setting::error);
  return pareto.error.name + " " + scale.with_unit(scale.estimate(setting.error));
}

std::string cost_words(const Pareto& pareto, const Setting& setting) {
  const DisplayScale scale = scale_of(pareto, pareto.cost, &Setting::cost);
  return pareto.cost.name + " " + scale.with_unit(cost_text(setting, scale));
}

std::string bound_words(const Pareto& pareto, double bound) {
  const DisplayScale scale = scale_of(pareto, pareto.error, &Setting::error);
  return scale.with_unit(fmt::format("{:.6g}", bound / scale.factor));
}

namespace {

/// A gnuplot script under construction: data blocks, and the clauses of its single plot command.
struct PlotScript {
  std::string text;
  std::string clauses;

  void plot(const std::string& clause) { clauses += (clauses.empty() ? "plot " : ", \\\n  ") + clause; }
  /// Adds a data block and the clauses that use it. Adds nothing if `lines` is empty.
  void draw(const std::string& name, const std::string& lines, const std::vector<std::string>& uses) {
    if (lines.empty()) return;
    text += fmt::format("${} << END\n{}END\n", name, lines);
    for (const std::string& use : uses) plot(fmt::format("${} using {}", name, use));
  }
};

/// Returns the gnuplot settings of title, axes, margins and key.
std::string frame_settings(const Pareto& pareto, const std::string& title, const PlotAxis& x, const PlotAxis& y) {
  const std::string error =
      fmt::format("mean {}{}", y.scale.title(pareto.error.name), pareto.more_is_better() ? " (more is better)" : "");
  const std::string scales =
      std::string(x.logarithmic ? "set logscale x\n" : "") + (y.logarithmic ? "set logscale y\n" : "");
  return fill_template("pareto", gnuplot_text(title), gnuplot_text("mean " + x.scale.title(pareto.cost.name)),
                       gnuplot_text(error), scales, x.low, x.high, y.low, y.high, kKeyLeft - 0.02, kKeyLeft);
}

void draw_fronts(PlotScript& script, const Pareto& pareto, const std::vector<std::string>& fronts) {
  for (std::size_t scene = 0; scene < fronts.size(); ++scene) {
    const char* const colour = kFrontColours[scene % kFrontColours.size()];
    const std::string name = pareto.scenes[scene].empty() ? "front: not dominated" : "front: " + pareto.scenes[scene];
    script.draw(fmt::format("front_{}", scene + 1), fronts[scene],
                {fmt::format("1:4 with steps lw 2 lc rgb '{}' title {}", colour, gnuplot_text(name)),
                 fmt::format("1:4:2:3:5:6 with xyerrorbars pt 7 ps 0.1 lw 1.5 lc rgb '{}' notitle", colour),
                 fmt::format("1:4 with points pt 7 ps 2.4 lc rgb '{}' notitle", colour)});
  }
}

}  // namespace

std::string pareto_script(const Pareto& pareto, const std::string& title, const std::optional<double>& bound,
                          const Setting* chosen) {
  const PlotAxis x = plot_axis(pareto, pareto.cost, &Setting::cost, {});
  const PlotAxis y = plot_axis(pareto, pareto.error, &Setting::error, bound);
  std::vector<std::string> fronts(pareto.scenes.size());
  std::string others;
  std::string incomplete;
  std::string choice;
  for (const Setting& one : pareto.settings) {
    if (one.cost.count == 0) continue;
    const std::string line = fmt::format("{} {} {}\n", x.columns(one.cost), y.columns(one.error), one.front);
    (one.front > 0 ? fronts[one.scene] : one.complete() ? others : incomplete) += line;
    if (&one == chosen) choice = line;
  }
  PlotScript script{frame_settings(pareto, title, x, y), {}};
  script.draw(
      "incomplete", incomplete,
      {"1:4:2:3:5:6 with xyerrorbars pt 2 ps 1.3 lc rgb '#b0b0b0' title 'not compared: jobs failed or missing'"});
  script.draw("others", others, {"1:4:2:3:5:6 with xyerrorbars pt 7 ps 1.1 lc rgb '#8fb0cc' title 'dominated'"});
  if (bound)
    script.plot(fmt::format("{} with lines dt 2 lw 2 lc rgb '{}' title {}", *bound / y.scale.factor, kChosenColour,
                            gnuplot_text((pareto.more_is_better() ? "limit: at least " : "limit: at most ") +
                                         bound_words(pareto, *bound))));
  draw_fronts(script, pareto, fronts);
  script.draw("choice", choice,
              {fmt::format("1:4 with points pt 7 ps 2.4 lc rgb '{}' title 'cheapest setting whose 95 % bound is within "
                           "the limit'",
                           kChosenColour)});
  for (std::size_t scene = 0; scene < fronts.size(); ++scene) {
    if (fronts[scene].empty()) continue;
    script.plot(fmt::format(
        "$front_{} using 1:4:(sprintf('%d', column(7))) with labels font ',10' tc rgb 'white' notitle", scene + 1));
  }
  for (const std::string& clause : named_settings(pareto, chosen)) script.plot(clause);
  return script.text + script.clauses + "\n";
}

}  // namespace palpate
