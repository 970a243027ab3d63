// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"
#include "record/fields.hpp"
#include "report/figures/gallery.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// One line of a panel: values after so many taps.
struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

struct Panel {
  std::string title;  ///< with its unit
  std::vector<Curve> curves;
  bool from_zero = true;
  bool logarithmic = false;  ///< where the values differ much
  bool share = false;        ///< from 0 to 1
};

/// A value of every moment that has it.
template <class Get>
Curve curve_of(const History& history, const std::string& name, const Get& get) {
  Curve curve{name, {}};
  for (const Moment& moment : history.moments) {
    if (const std::optional<double> value = get(moment)) curve.points.emplace_back(moment.taps, *value);
  }
  return curve;
}

void add(Panel& panel, Curve curve) {
  const bool drawn = curve.points.size() >= 2 &&
                     (!panel.logarithmic || std::any_of(curve.points.begin(), curve.points.end(),
                                                        [](const auto& point) { return point.second > 0.0; }));
  if (drawn) panel.curves.push_back(std::move(curve));
}

Panel errors_panel(const Recording& recording, const History& history) {
  Panel panel{"error, rms [cm]", {}};
  const auto add_error = [&](const char* name, std::optional<double> Errors::*error) {
    add(panel, curve_of(history, name, [&](const Moment& moment) {
          const std::optional<double>& value = moment.result.errors.*error;
          return value ? std::optional(100.0 * *value) : std::nullopt;
        }));
  };
  add_error("scene", &Errors::rmse);
  add_error("on the object", &Errors::rmse_on_surface);
  if (recording.config.options.surface == ExperimentOptions::Surface::two_part)
    add_error("on the object, its height mean", &Errors::rmse_height);
  return panel;
}

Panel outline_panel(const History& history) {
  Panel panel{"outline, intersection over union", {}};
  panel.share = true;
  add(panel, curve_of(history, "", [](const Moment& moment) { return moment.result.errors.footprint_iou; }));
  return panel;
}

Panel deviation_panel(const History& history) {
  Panel panel{"largest standard deviation [cm]", {}};
  add(panel,
      curve_of(history, "", [](const Moment& moment) { return std::optional(100.0 * moment.largest_deviation); }));
  return panel;
}

Panel share_panel(const History& history) {
  Panel panel{"share of the taps on the object", {}};
  panel.share = true;
  // Of a single tap, too: so no run is without a panel.
  panel.curves.push_back(curve_of(history, "", [](const Moment& moment) {
    return moment.taps > 0 ? std::optional(static_cast<double>(moment.result.on_surface_taps) / moment.taps)
                           : std::nullopt;
  }));
  return panel;
}

struct NamedState {
  const char* name;
  std::optional<ProcessState> RunResult::*state;
};
constexpr std::array<NamedState, 3> kStates{{{"heights", &RunResult::height_process},
                                             {"labels", &RunResult::weight_process},
                                             {"object", &RunResult::surface_process}}};

Panel likelihood_panel(const History& history) {
  Panel panel{"log marginal likelihood", {}};
  panel.from_zero = false;
  for (const NamedState& one : kStates) {
    add(panel, curve_of(history, one.name, [&](const Moment& moment) {
          const std::optional<ProcessState>& state = moment.result.*one.state;
          return state ? std::optional(state->log_marginal_likelihood) : std::nullopt;
        }));
  }
  return panel;
}

/// The hyperparameters of a process by name.
std::vector<std::pair<std::string, double>> parameters_of(const ProcessState& state) {
  std::vector<std::pair<std::string, double>> out{{"signal", state.settings.signal}, {"noise", state.settings.noise}};
  for (const KernelParameter& one : state.kernel) out.emplace_back(one.name, one.value);
  return out;
}

Panel hyperparameters_panel(const History& history, const NamedState& which) {
  Panel panel{fmt::format("hyperparameters, {} (SI units)", which.name), {}};
  panel.logarithmic = true;
  const std::optional<ProcessState>& first = history.moments.front().result.*which.state;
  if (!first) return panel;
  const auto names = parameters_of(*first);
  for (std::size_t i = 0; i < names.size(); ++i) {
    add(panel, curve_of(history, names[i].first, [&](const Moment& moment) {
          return std::optional(parameters_of(*(moment.result.*which.state))[i].second);
        }));
  }
  return panel;
}

Panel phases_panel(const Recording& recording) {
  Panel panel{"time of a tap, by phase [ms]", {}};
  panel.logarithmic = true;
  const Timings timings = read_timings(recording.directory);
  if (timings.trouble) throw Error(*timings.trouble);
  for (std::size_t i = 0; i < kPhases; ++i) {
    Curve curve{kPhaseNames[i], {}};
    for (const TapTimes& tap : timings.taps) {
      if (tap.seconds[i] > 0.0) curve.points.emplace_back(tap.tap, 1e3 * tap.seconds[i]);
    }
    add(panel, std::move(curve));
  }
  return panel;
}

Panel robot_panel(const History& history) {
  Panel panel{"robot time [s]", {}};
  if (history.moments.back().result.robot_seconds > 0.0)
    add(panel, curve_of(history, "", [](const Moment& moment) { return std::optional(moment.result.robot_seconds); }));
  return panel;
}

/// Told apart by people who see two colours alike (Okabe and Ito).
constexpr std::array<const char*, 8> kLines{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                            "#56b4e9", "#e69f00", "#000000", "#8c6d31"};

constexpr std::size_t kLongestName = 22;  ///< of which two stand side by side
constexpr std::size_t kMostNames = 10;
constexpr double kNameHeight = 17;

/// Names of curves side by side.
std::size_t columns_of(const Panel& panel) {
  return std::all_of(panel.curves.begin(), panel.curves.end(),
                     [](const Curve& one) { return one.name.size() <= kLongestName; })
             ? 2
             : 1;
}

/// Lines of names above the panel: over the curves they would hide them.
std::size_t name_lines(const Panel& panel) {
  if (panel.curves.front().name.empty()) return 0;
  return (std::min(panel.curves.size(), kMostNames) + columns_of(panel) - 1) / columns_of(panel);
}

/// The names from `top` down, with the colours of their curves.
std::string names(const Sheet& sheet, const Box& box, double top, const Panel& panel) {
  std::string out;
  const std::size_t columns = columns_of(panel);
  if (name_lines(panel) == 0) return out;
  for (std::size_t i = 0; i < std::min(panel.curves.size(), kMostNames); ++i) {
    const double x = box.left + 6 + 160.0 * static_cast<double>(i % columns);
    const std::size_t line = i / columns;
    const double y = top + kNameHeight * (static_cast<double>(line) + 0.5);
    const bool rest = i + 1 == kMostNames && panel.curves.size() > kMostNames;
    out += fmt::format(
        "set label {} at screen {:.5f}, screen {:.5f} left font ',10' point pt 7 ps 1 lc rgb '{}' "
        "offset 0.8,-0.25\n",
        gnuplot_text(rest ? fmt::format("and {} more", panel.curves.size() - i) : panel.curves[i].name),
        x / sheet.width(), 1.0 - y / sheet.height(), kLines[i % kLines.size()]);
  }
  return out;
}

/// Whether the values span more than a linear axis shows.
bool wide(const Panel& panel) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const Curve& curve : panel.curves) {
    for (const auto& point : curve.points) {
      if (point.second > 0.0) least = std::min(least, point.second);
      most = std::max(most, point.second);
    }
  }
  return most > 20.0 * least;
}

void draw(Sheet& sheet, const Box& box, double top, const Panel& panel, int number, int taps) {
  std::string settings =
      "set border 3 lc rgb '#555555'\nset tics nomirror out scale 0.5 font ',10'\nset grid lc rgb '#e4e4e4' lt 1\n";
  settings += fmt::format("set xrange [0:{}]\nset xlabel 'taps' font ',10' offset 0,0.6\n", std::max(1, taps));
  if (panel.logarithmic && wide(panel)) {
    settings += "set logscale y\nset format y '%g'\n";
  } else if (panel.share) {
    settings += "set yrange [0:1]\n";
  } else if (panel.from_zero) {
    settings += "set yrange [0:*]\n";
  }
  settings += names(sheet, box, top + 24, panel);
  std::string clauses = "plot ";
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    std::string lines;
    for (const auto& [tap, value] : panel.curves[i].points) lines += fmt::format("{} {:.10g}\n", tap, value);
    const std::string name = fmt::format("curve_{}_{}", number, i + 1);
    sheet.data(name, lines);
    clauses += fmt::format("{}${} using 1:2 with linespoints lw 2 pt 7 ps 0.6 dt {} lc rgb '{}'",
                           i > 0 ? ", \\\n  " : "", name, 1 + i / kLines.size(), kLines[i % kLines.size()]);
  }
  sheet.text(panel.title, box.left, top, 12);
  sheet.plot(box, settings, clauses);
}

}  // namespace

Figure curves_figure(const Recording& recording, const History& history, const Snapshot& last) {
  constexpr int kColumns = 4;
  constexpr double kWidth = 280;
  constexpr double kHeight = 200;
  std::vector<Panel> panels{errors_panel(recording, history), outline_panel(history), deviation_panel(history),
                            share_panel(history), likelihood_panel(history)};
  for (const NamedState& one : kStates) panels.push_back(hyperparameters_panel(history, one));
  panels.push_back(phases_panel(recording));
  panels.push_back(robot_panel(history));
  panels.erase(std::remove_if(panels.begin(), panels.end(), [](const Panel& one) { return one.curves.empty(); }),
               panels.end());
  const int count = static_cast<int>(panels.size());
  const int columns = std::clamp(count, 1, kColumns);
  std::vector<double> title_tops;  // of each row of panels
  std::vector<double> tops;
  double bottom = 70;
  for (int first = 0; first < count; first += kColumns) {
    std::size_t lines = 0;
    for (int i = first; i < std::min(count, first + kColumns); ++i)
      lines = std::max(lines, name_lines(panels[static_cast<std::size_t>(i)]));
    title_tops.push_back(bottom + 8);
    tops.push_back(bottom + 42 + kNameHeight * static_cast<double>(lines));
    bottom = tops.back() + kHeight + 60;
  }
  Sheet sheet(70 + columns * 365, static_cast<int>(bottom));
  sheet.text(recording.config.options.name, 60, 14, 15);
  sheet.text(fmt::format("{} taps: {}", last.taps, count_words(last)), 60, 42, 11);
  for (int i = 0; i < count; ++i) {
    const Box box{60.0 + 365 * (i % kColumns), tops[static_cast<std::size_t>(i / kColumns)], kWidth, kHeight};
    draw(sheet, box, title_tops[static_cast<std::size_t>(i / kColumns)], panels[static_cast<std::size_t>(i)], i + 1,
         last.taps);
  }
  return {"curves", std::move(sheet)};
}

}  // namespace palpate
