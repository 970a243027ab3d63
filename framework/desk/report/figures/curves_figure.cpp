// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"
#include "record/fields.hpp"
#include "report/curves.hpp"
#include "report/figures/gallery.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

/// Told apart by people who see two colours alike (Okabe and Ito).
constexpr std::array<const char*, 8> kLines{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                            "#56b4e9", "#e69f00", "#000000", "#8c6d31"};

constexpr double kNameHeight = 17;

/// Names of curves side by side.
std::size_t columns_of(const CurvePanel& panel) {
  constexpr std::size_t kLongestOfTwo = 22;
  const auto is_short = [](const Curve& one) { return one.name.size() <= kLongestOfTwo; };
  return std::all_of(panel.curves.begin(), panel.curves.end(), is_short) ? 2 : 1;
}

/// Lines of names above the panel: over the curves they would hide them.
std::size_t name_lines(const CurvePanel& panel) {
  if (panel.curves.front().name.empty()) return 0;
  return (panel.curves.size() + columns_of(panel) - 1) / columns_of(panel);
}

/// gnuplot's settings of an axis.
const char* axis_settings(CurveAxis axis) {
  switch (axis) {
    case CurveAxis::free:
      break;
    case CurveAxis::from_zero:
      return "set yrange [0:*]\n";
    case CurveAxis::share:
      return "set yrange [0:1]\n";
    case CurveAxis::logarithmic:
      return "set logscale y\nset format y '%g'\n";
  }
  return "";
}

void draw(Sheet& sheet, const Box& box, double top, const CurvePanel& panel, int number, int taps) {
  std::string settings =
      "set border 3 lc rgb '#555555'\nset tics nomirror out scale 0.5 font ',10'\nset grid lc rgb '#e4e4e4' lt 1\n";
  settings += fmt::format("set xrange [0:{}]\nset xlabel 'taps' font ',10' offset 0,0.6\n", std::max(1, taps));
  settings += axis_settings(panel.axis);
  settings += fmt::format(
      "set key at graph 0, graph 1.03 left bottom Left reverse horizontal maxcols {} samplen 1 font ',10'\n",
      columns_of(panel));
  std::string clauses = "plot ";
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    std::string lines;
    const std::vector<std::optional<double>>& values = panel.curves[i].values;
    for (std::size_t tap = 0; tap < values.size(); ++tap) {
      if (values[tap]) lines += fmt::format("{} {:.10g}\n", tap, *values[tap]);
    }
    const std::string name = fmt::format("curve_{}_{}", number, i + 1);
    sheet.data(name, lines);
    clauses += fmt::format("{}${} using 1:2 with linespoints lw 2 pt 7 ps 0.6 dt {} lc rgb '{}' title {}",
                           i > 0 ? ", \\\n  " : "", name, 1 + i / kLines.size(), kLines[i % kLines.size()],
                           gnuplot_text(panel.curves[i].name));
  }
  sheet.text(panel.full_title(), box.left, top, 12);
  sheet.plot(box, settings, clauses);
}

}  // namespace

Figure curves_figure(const Recording& recording, const History& history) {
  constexpr int kColumns = 4;
  constexpr double kWidth = 280;
  constexpr double kHeight = 200;
  if (const std::optional<Error> trouble = read_timings(recording.directory).trouble) throw Error(*trouble);
  const RunResult& last = history.moments.back().result;
  const std::vector<CurvePanel> panels = curves_of(recording, history);
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
