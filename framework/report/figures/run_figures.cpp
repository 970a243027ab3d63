// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"
#include "analysis/mean_output.hpp"
#include "config/text_layout.hpp"
#include "report/curves.hpp"
#include "report/figures/figure_layout.hpp"
#include "report/figures/figures.hpp"
#include "report/words/titles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {
namespace {

std::string after_words(const MapsAtTap& snapshot) {
  return fmt::format("after tap {}: {}", snapshot.taps, count_words(snapshot.result));
}

Figure surface_figure(const ExperimentOptions& options, const SceneFrame& frame, const MapsAtTap& last) {
  FigureLayout layout(1000, 700);
  layout.data("surface", surface_of(frame, last.surface, last.deviation));
  const MapsAtTap seen = without_hidden_taps(last, frame);
  layout.taps("last", seen);
  layout.text(options.name, 30, 16, 15);
  const auto behind = last.marks.size() - seen.marks.size();
  layout.text(map_titles(options).at("height") + " " + after_words(last) +
                  (behind > 0 ? fmt::format("; {} of them hidden behind it", behind) : ""),
              30, 44, 11);
  const ColourScale colours = deviation_colours(last.deviation.minCoeff(), last.deviation.maxCoeff());
  layout.surface({90, 80, 740, 510}, frame, "surface", "last", colours, z_range_of({last}, frame));
  layout.bar({880, 160, 18, 380}, colours);
  layout.legend(36, 670, last.result.failed_taps > 0, false);
  return {"surface", std::move(layout)};
}

/// A map with its colour scale. The scale begins at 0.
struct MapPanel {
  const char* name;
  Eigen::VectorXd values;
  Palette palette;
  double high;
  std::string outside;  ///< text with the range of the values, if some values are outside the scale
};

/// Returns the maps of the uncertainty u, the weight w and e = u w if the footprint is the label GP. Otherwise returns
/// the maps of u, the probability p of an object, and the score.
std::vector<MapPanel> map_panels(const MapsAtTap& last) {
  const auto outside = [](const Eigen::VectorXd& values, double high) {
    if (values.minCoeff() >= -5e-4 && values.maxCoeff() <= high + 5e-4) return std::string();
    return fmt::format("\nrange: {:.2f} to {:.2f}", values.minCoeff(), values.maxCoeff());
  };
  // If the footprint is the label GP (whose mean is w), the figure shows the exploration term e = u w instead of the
  // score.
  const Eigen::VectorXd e = last.has_weight() ? last.exploration() : last.scores;
  const double most = e.maxCoeff() > 0.0 ? e.maxCoeff() : 1.0;
  std::vector<MapPanel> panels{{"u", last.uncertainty, Palette::cividis, 1.0, ""}};
  if (last.has_weight()) {
    panels.push_back({"w", last.weight, Palette::viridis, 1.0, outside(last.weight, 1)});
    panels.push_back({"e", e, Palette::viridis, most, outside(e, most)});
  } else {
    panels.push_back({"p", last.probability, Palette::viridis, 1.0, ""});
    if (last.has_scores) panels.push_back({"score", e, Palette::viridis, most, outside(e, most)});
  }
  return panels;
}

Figure maps_figure(const ExperimentOptions& options, const SceneFrame& frame, const MapsAtTap& last) {
  constexpr double kMargin = 70;
  constexpr double kTop = 118;
  constexpr double kPitch = 440;
  constexpr double kSide = 290;
  const Box first = map_box(frame.area, kMargin, kTop, kSide);
  const std::vector<MapPanel> panels = map_panels(last);
  const double steps = static_cast<double>(panels.size() - 1);  // number of steps from the first panel to the last
  FigureLayout layout(static_cast<int>(kMargin + steps * kPitch + kSide + 90),
                      static_cast<int>(kTop + first.height + 96));
  const std::map<std::string, std::string> titles = map_titles(options);
  layout.text(options.name, kMargin, 14, 15);
  layout.text(fmt::format("{}; strategy {}", after_words(last), options.acquisition.type), kMargin, 42, 11);
  for (const MapPanel& panel : panels) layout.data(panel.name, matrix_of(frame, panel.values));
  layout.taps("last", last);
  double left = first.left;
  for (const MapPanel& panel : panels) {
    const ColourScale colours{panel.palette, 0.0, panel.high, ""};
    layout.text(titles.at(panel.name) + panel.outside, left + 0.5 * first.width, kTop - 44, 11,
                FigureLayout::Align::centre);
    layout.map({left, kTop, first.width, first.height}, frame, panel.name, "last", colours);
    layout.bar({left + first.width + 14, kTop, 14, first.height}, colours);
    left += kPitch;
  }
  layout.legend(kMargin + 6, kTop + first.height + 68, last.result.failed_taps > 0, last.next.has_value());
  return {"maps", std::move(layout)};
}

constexpr double kNameHeight = 17;

/// Returns the number of curve names per line of the legend.
std::size_t columns_of(const CurvePanel& panel) {
  constexpr std::size_t kLongestOfTwo = 22;
  const auto is_short = [](const Curve& one) { return one.name.size() <= kLongestOfTwo; };
  return std::all_of(panel.curves.begin(), panel.curves.end(), is_short) ? 2 : 1;
}

/// Returns the number of lines with curve names. These lines are above the panel, where they hide no curve.
std::size_t name_lines(const CurvePanel& panel) {
  if (panel.curves.front().name.empty()) return 0;
  return (panel.curves.size() + columns_of(panel) - 1) / columns_of(panel);
}

void draw_curves(FigureLayout& layout, const Box& box, double top, const CurvePanel& panel, int number, int taps) {
  // commands in the order of ValueAxisScale
  constexpr const char* kAxes[] = {"", "set yrange [0:*]\n", "set yrange [0:1]\n",
                                   "set logscale y\nset format y '%g'\n"};
  const std::string settings =
      fill_template("run_curves", std::max(1, taps), kAxes[static_cast<std::size_t>(panel.axis)], columns_of(panel));
  std::string clauses = "plot ";
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    std::string lines;
    const std::vector<std::optional<double>>& values = panel.curves[i].values;
    for (std::size_t tap = 0; tap < values.size(); ++tap) {
      if (values[tap]) lines += fmt::format("{} {:.10g}\n", tap, *values[tap]);
    }
    const std::string name = fmt::format("curve_{}_{}", number, i + 1);
    layout.data(name, lines);
    clauses += fmt::format("{}${} using 1:2 with linespoints lw 2 pt 7 ps 0.6 dt {} lc rgb '{}' title {}",
                           i > 0 ? ", \\\n  " : "", name, 1 + i / kLineColours.size(),
                           kLineColours[i % kLineColours.size()], gnuplot_text(panel.curves[i].name));
  }
  layout.text(panel.full_title(), box.left, top, 12);
  layout.plot(box, settings, clauses);
}

/// Draws the curves of the run against the taps.
Figure curves_figure(const RecordedRun& recording, const History& history) {
  constexpr int kColumns = 4;
  constexpr double kWidth = 280;
  constexpr double kHeight = 200;
  const RunResult& last = history.moments.back().result;
  const auto [panels, constants] = curves_of(recording, history);
  const int count = static_cast<int>(panels.size());
  const int columns = std::clamp(count, 1, kColumns);
  std::vector<double> title_tops;  // one top edge per row of panels
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
  // Constants are listed below the panels.
  const int width = 70 + columns * 365;
  std::vector<std::string> words;
  if (!constants.empty()) words.emplace_back("Constant over all taps:");
  for (const std::string& one : constants) {
    for (std::string& line : wrapped(one, static_cast<std::size_t>(width - 90) / 8)) words.push_back(std::move(line));
  }
  FigureLayout layout(width, static_cast<int>(bottom + 18 * static_cast<double>(words.size())));
  layout.text(fmt::format("{}", fmt::join(words, "\n")), 60, bottom - 8, 11);
  layout.text(recording.config.options.name, 60, 14, 15);
  layout.text(fmt::format("{} taps: {}", last.taps, count_words(last)), 60, 42, 11);
  for (int i = 0; i < count; ++i) {
    const Box box{60.0 + 365 * (i % kColumns), tops[static_cast<std::size_t>(i / kColumns)], kWidth, kHeight};
    draw_curves(layout, box, title_tops[static_cast<std::size_t>(i / kColumns)], panels[static_cast<std::size_t>(i)],
                i + 1, last.taps);
  }
  return {"curves", std::move(layout)};
}

}  // namespace

Figures write_run_figures(const RunEnvironment& environment, const RecordedRun& recording, const History& history,
                          const std::filesystem::path& folder) {
  RunReplay playback(environment, recording, page_readers(recording));
  const MapsAtTap last = maps_at_taps(playback, recording, {static_cast<int>(recording.taps.size())}).front();
  const SceneFrame frame = scene_frame_of(playback.experiment());
  const ExperimentOptions& options = recording.config.options;
  return {write_figures(folder, {surface_figure(options, frame, last), maps_figure(options, frame, last),
                                 curves_figure(recording, history)}),
          {}};
}

}  // namespace palpate
