// SPDX-License-Identifier: MIT
#include "analysis/pareto_report.hpp"

#include "analysis/gnuplot.hpp"
#include "analysis/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace palpate {
namespace {

using Pick = std::function<const MeanEstimate&(const Setting&)>;
const MeanEstimate& cost_of(const Setting& setting) { return setting.cost; }
const MeanEstimate& error_of(const Setting& setting) { return setting.error; }

Scale scale_of(const Pareto& pareto, const ParetoKey& key, const Pick& pick) {
  std::vector<double> means;
  for (const Setting& setting : pareto.settings) {
    if (pick(setting).count > 0) means.push_back(pick(setting).mean);
  }
  return readable_scale(key.unit, means);
}

std::string note_of(const Setting& setting) {
  std::string note;
  const auto add = [&](int count, const char* what) {
    if (count > 0) note += fmt::format("{}{} of {} {}", note.empty() ? "" : ", ", count, setting.jobs, what);
  };
  add(setting.failed, "failed");
  add(setting.unfinished, "unfinished");
  add(setting.without_value, "without a value");
  return note;
}

std::string cost_text(const Setting& setting, const Scale& scale) {
  const MeanEstimate& cost = setting.cost;
  if (cost.count == 0) return "-";
  const std::string half = cost.interval ? scale.number((cost.interval->high - cost.interval->low) / 2) : "-";
  return fmt::format("{} +- {}", scale.number(cost.mean), half);
}

std::string error_text(const Setting& setting, const Scale& scale) {
  if (setting.error.count == 0) return "-";
  return fmt::format("{} {}", scale.number(setting.error.mean), scale.interval(setting.error.interval));
}

}  // namespace

std::string pareto_table(const Pareto& pareto) {
  const Scale cost = scale_of(pareto, pareto.cost, cost_of);
  const Scale error = scale_of(pareto, pareto.error, error_of);
  std::vector<std::vector<std::string>> lines{
      {"front", "setting", "jobs", cost.title(pareto.cost.name), error.title(pareto.error.name), ""}};
  for (const Setting& one : pareto.settings) {
    lines.push_back({one.front > 0 ? std::to_string(one.front) : "", one.name, std::to_string(one.jobs),
                     cost_text(one, cost), error_text(one, error), note_of(one)});
  }
  std::string out = aligned(lines, "rlrrrl");
  out += fmt::format(
      "mean over the seeds, with its 95 % interval; {} of {} is better; numbered: no other setting is at "
      "least as good in both\n",
      pareto.error.more_is_better ? "more" : "less", pareto.error.name);
  const bool all_complete =
      std::all_of(pareto.settings.begin(), pareto.settings.end(), [](const Setting& one) { return one.complete(); });
  if (!all_complete) out += "settings with jobs that failed, are missing or have no value are not compared\n";
  return out;
}

std::vector<Row> pareto_rows(const Pareto& pareto) {
  std::vector<Row> rows;
  for (const Setting& one : pareto.settings) {
    Row row;
    row.add("front", one.front > 0 ? std::optional(one.front) : std::nullopt);
    for (std::size_t i = 0; i < pareto.keys.size(); ++i) row.add(pareto.keys[i], one.values[i]);
    row.add("jobs", one.jobs);
    row.add("failed", one.failed);
    row.add("unfinished", one.unfinished);
    row.add("without_value", one.without_value);
    const auto add = [&row](const std::string& name, const MeanEstimate& estimate) {
      row.add(name + ".mean", estimate.count > 0 ? std::optional(estimate.mean) : std::nullopt);
      row.add(name + ".low_95", estimate.interval ? std::optional(estimate.interval->low) : std::nullopt);
      row.add(name + ".high_95", estimate.interval ? std::optional(estimate.interval->high) : std::nullopt);
    };
    add(pareto.cost.name, one.cost);
    add(pareto.error.name, one.error);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string error_words(const Pareto& pareto, const Setting& setting) {
  const Scale scale = scale_of(pareto, pareto.error, error_of);
  return fmt::format("{} {}{}", pareto.error.name, error_text(setting, scale),
                     scale.unit.empty() ? "" : " " + scale.unit);
}

std::string cost_words(const Pareto& pareto, const Setting& setting) {
  const Scale scale = scale_of(pareto, pareto.cost, cost_of);
  return fmt::format("{} {}{}", pareto.cost.name, cost_text(setting, scale),
                     scale.unit.empty() ? "" : " " + scale.unit);
}

std::string bound_words(const Pareto& pareto, double bound) {
  const Scale scale = scale_of(pareto, pareto.error, error_of);
  return fmt::format("{:.6g}{}", bound / scale.factor, scale.unit.empty() ? "" : " " + scale.unit);
}

namespace {

/// Ends of an axis in its unit, and whether it is logarithmic.
struct AxisRange {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;

  /// A bar may begin at or below 0, which a logarithmic axis has not.
  double clipped(double value) const { return logarithmic ? std::max(value, low) : value; }
};

AxisRange axis_range(const Pareto& pareto, const Pick& pick, const Scale& scale, const std::optional<double>& line) {
  constexpr double kLogarithmicFrom = 20.0;
  std::vector<double> means;
  std::vector<double> ends;
  for (const Setting& one : pareto.settings) {
    const MeanEstimate& estimate = pick(one);
    if (estimate.count == 0) continue;
    means.push_back(estimate.mean / scale.factor);
    const MeanInterval interval = estimate.interval.value_or(MeanInterval{estimate.mean, estimate.mean});
    ends.push_back(interval.low / scale.factor);
    ends.push_back(interval.high / scale.factor);
  }
  if (line) ends.push_back(*line / scale.factor);
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  const auto [low, high] = std::minmax_element(ends.begin(), ends.end());
  AxisRange range;
  range.logarithmic = *least > 0.0 && *most / *least > kLogarithmicFrom && (!line || *line > 0.0);
  if (range.logarithmic) {
    const double bottom = *low > *least / 4 ? *low : *least / 4;
    const double margin = std::pow(*high / bottom, 0.06);
    range.low = bottom / margin;
    range.high = *high * margin;
  } else {
    const double margin = *high > *low ? 0.06 * (*high - *low) : std::max(0.1 * std::abs(*high), 1e-12);
    range.low = *low - margin;
    range.high = *high + margin;
  }
  return range;
}

/// x y xlow xhigh ylow yhigh number, a setting a line.
class PointWriter {
 public:
  PointWriter(const Scale& cost, const Scale& error, const AxisRange& x, const AxisRange& y)
      : cost_(cost), error_(error), x_(x), y_(y) {}

  std::string line(const Setting& one) const {
    return fmt::format("{} {} {} {} {}\n", one.cost.mean / cost_.factor, one.error.mean / error_.factor,
                       ends(one.cost, cost_, x_), ends(one.error, error_, y_), one.front);
  }

 private:
  static std::string ends(const MeanEstimate& estimate, const Scale& scale, const AxisRange& range) {
    const MeanInterval interval = estimate.interval.value_or(MeanInterval{estimate.mean, estimate.mean});
    return fmt::format("{} {}", range.clipped(interval.low / scale.factor),
                       range.clipped(interval.high / scale.factor));
  }

  const Scale& cost_;
  const Scale& error_;
  const AxisRange& x_;
  const AxisRange& y_;
};

constexpr double kListLeft = 0.635;  // of the picture's width: where the list of names begins

/// The name in lines that fit beside the plot, broken behind commas where it can be.
std::vector<std::string> wrapped(const std::string& name) {
  constexpr std::size_t kLongest = 48;
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < name.size();) {
    std::size_t end = name.size();
    if (end - begin > kLongest) {
      const auto comma = name.rfind(", ", begin + kLongest - 1);
      end = comma != std::string::npos && comma > begin ? comma + 2 : begin + kLongest;
    }
    lines.push_back(name.substr(begin, end - begin));
    begin = end;
  }
  return lines;
}

constexpr const char* kFrontColour = "#0b5394";
constexpr const char* kChosenColour = "#c1440e";

/// An entry of the list at height `y`, which it lowers: the mark that the setting has in the picture, and its name.
std::string list_entry(const Setting& one, const char* colour, double& y) {
  std::string out = fmt::format("set label '' at screen {}, screen {} point pt 7 ps 2.4 lc rgb '{}' front\n",
                                kListLeft + 0.012, y, colour);
  if (one.front > 0) {
    out += fmt::format("set label '{}' at screen {}, screen {} center tc rgb 'white' font ',10' front\n", one.front,
                       kListLeft + 0.012, y);
  }
  for (const std::string& line : wrapped(one.name)) {
    out +=
        fmt::format("set label {} at screen {}, screen {} left font ',11'\n", gnuplot_text(line), kListLeft + 0.03, y);
    y -= 0.026;
  }
  y -= 0.01;
  return out;
}

/// The names of the numbered settings, and of the chosen one, from the top of the right side down.
std::string front_list(const Pareto& pareto, const Setting* chosen) {
  constexpr double kTop = 0.9;
  constexpr double kBottom = 0.27;  // the key is below
  std::string out;
  double y = kTop;
  int left_out = 0;
  for (const Setting& one : pareto.settings) {
    if (one.front == 0 && &one != chosen) continue;
    if (y > kBottom || &one == chosen) {
      out += list_entry(one, &one == chosen ? kChosenColour : kFrontColour, y);
    } else {
      ++left_out;
    }
  }
  if (left_out > 0) {
    out += fmt::format("set label 'and {} more, see the table' at screen {}, screen {} left font ',11'\n", left_out,
                       kListLeft + 0.03, y);
  }
  return out;
}

}  // namespace

std::string pareto_script(const Pareto& pareto, const std::string& title, const std::optional<double>& bound,
                          const Setting* chosen) {
  const Scale cost = scale_of(pareto, pareto.cost, cost_of);
  const Scale error = scale_of(pareto, pareto.error, error_of);
  const AxisRange x = axis_range(pareto, cost_of, cost, {});
  const AxisRange y = axis_range(pareto, error_of, error, bound);
  const PointWriter points(cost, error, x, y);
  std::string front;
  std::string others;
  std::string incomplete;
  std::string choice;
  for (const Setting& one : pareto.settings) {
    if (one.cost.count == 0) continue;
    (one.front > 0 ? front : one.complete() ? others : incomplete) += points.line(one);
    if (&one == chosen) choice = points.line(one);
  }

  std::string out;
  std::string plots;
  const auto plot = [&](const std::string& clause) { plots += (plots.empty() ? "plot " : ", \\\n  ") + clause; };
  const auto block = [&](const char* name, const std::string& lines) {
    out += fmt::format("${} << END\n{}END\n", name, lines);
  };
  out += fmt::format("set title {} font ',14'\n", gnuplot_text(title));
  out += fmt::format("set xlabel {}\nset ylabel {}\n", gnuplot_text("mean " + cost.title(pareto.cost.name)),
                     gnuplot_text("mean " + error.title(pareto.error.name) +
                                  (pareto.error.more_is_better ? " (more is better)" : "")));
  if (x.logarithmic) out += "set logscale x\n";
  if (y.logarithmic) out += "set logscale y\n";
  out += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x.low, x.high, y.low, y.high);
  out += fmt::format("set lmargin at screen 0.075\nset rmargin at screen {}\n", kListLeft - 0.02);
  out += "set border 3 lc rgb '#555555'\nset tics nomirror\nset grid lc rgb '#e4e4e4' lt 1\n";
  out +=
      fmt::format("set key at screen {}, screen 0.21 left Left reverse samplen 2 spacing 1.4 font ',11'\n", kListLeft);
  out += front_list(pareto, chosen);
  if (!incomplete.empty()) {
    block("incomplete", incomplete);
    plot(
        "$incomplete using 1:2:3:4:5:6 with xyerrorbars pt 2 ps 1.3 lc rgb '#b0b0b0' "
        "title 'not compared: jobs failed or missing'");
  }
  if (!others.empty()) {
    block("others", others);
    plot("$others using 1:2:3:4:5:6 with xyerrorbars pt 7 ps 1.1 lc rgb '#8fb0cc' title 'dominated'");
  }
  if (bound) {
    plot(fmt::format("{} with lines dt 2 lw 2 lc rgb '#c1440e' title {}", *bound / error.factor,
                     gnuplot_text((pareto.error.more_is_better ? "wanted: at least " : "wanted: at most ") +
                                  bound_words(pareto, *bound))));
  }
  if (!front.empty()) {
    block("front", front);
    plot("$front using 1:2 with steps lw 2 lc rgb '#0b5394' title 'front: dominated by none'");
    plot("$front using 1:2:3:4:5:6 with xyerrorbars pt 7 ps 0.1 lw 1.5 lc rgb '#0b5394' notitle");
    plot("$front using 1:2 with points pt 7 ps 2.4 lc rgb '#0b5394' notitle");
  }
  if (!choice.empty()) {
    block("choice", choice);
    plot("$choice using 1:2 with points pt 7 ps 2.4 lc rgb '#c1440e' title 'cheapest whose 95 % bound keeps to it'");
  }
  if (!front.empty()) plot("$front using 1:2:(sprintf('%d', column(7))) with labels font ',10' tc rgb 'white' notitle");
  return out + plots + "\n";
}

}  // namespace palpate
