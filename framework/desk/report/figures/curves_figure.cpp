// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"
#include "analysis/group_curves_report.hpp"
#include "report/figures/figures.hpp"
#include "report/figures/sheet.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpate {
namespace {

constexpr std::size_t kMostScenes = 12;
constexpr std::size_t kMostCurves = 16;  ///< of a panel
constexpr std::size_t kMostAcross = 3;   ///< panels side by side

/// Colours that people who see two colours alike tell apart (Okabe and Ito 2008, Color universal design). From the
/// ninth curve on they return as dashed lines.
constexpr std::array<const char*, 8> kCurveColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                   "#56b4e9", "#e69f00", "#000000", "#8c6d46"};

std::string line_style(std::size_t curve) {
  return fmt::format("lw 2 dt {} lc rgb '{}'", curve < kCurveColours.size() ? 1 : 2,
                     kCurveColours[curve % kCurveColours.size()]);
}

/// The names of the groups, in the order of the sweep: a group has one colour in all panels.
std::vector<std::string> group_names(const GroupCurves& curves) {
  std::vector<std::string> out;
  for (const GroupCurve& curve : curves.curves) {
    std::string name = curve.name();
    if (!curve.points.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

/// The axis of the values. From 0 where none is below it, as errors and shares are; it keeps near the means, for the
/// intervals of the first taps may be wider than all else.
std::string value_range(const std::vector<const GroupCurve*>& panel, double factor) {
  double low = 0.0;
  double high = 0.0;
  double end = 0.0;
  bool begun = false;
  for (const GroupCurve* curve : panel) {
    for (const auto& point : curve->points) {
      if (point.mean.count == 0) continue;
      const double mean = point.mean.mean / factor;
      low = begun ? std::min(low, mean) : mean;
      high = begun ? std::max(high, mean) : mean;
      const double top = point.mean.interval ? point.mean.interval->high / factor : mean;
      end = begun ? std::max(end, top) : top;
      begun = true;
    }
  }
  const double room = std::max(high - low, 1e-9);
  const double top = std::min(end, high + 0.5 * room) + 0.04 * room;
  return fmt::format("set yrange [{:.6g}:{:.6g}]\n", low >= 0.0 ? 0.0 : low - 0.3 * room, top);
}

/// "at mean low high" of each point, in the units of the axes; NaN where there is none.
std::string block_of(const GroupCurve& curve, double axis, double factor) {
  std::string out;
  const auto number = [&](double value) { return fmt::format("{:.6g}", value / factor); };
  for (const CurvePoint& point : curve.points) {
    const auto& ends = point.mean.interval;
    out += fmt::format("{:.6g} {} {} {}\n", point.at / axis, point.mean.count > 0 ? number(point.mean.mean) : "NaN",
                       ends ? number(ends->low) : "NaN", ends ? number(ends->high) : "NaN");
  }
  return out;
}

constexpr double kNameRow = 20;
constexpr double kNameLeft = 24;
constexpr double kNameSample = 28;  ///< length of the line before a name

/// Where the names of the groups begin, in as many rows as they need: (x, row).
std::vector<std::pair<double, int>> place_names(const std::vector<std::string>& names, double width) {
  std::vector<std::pair<double, int>> out;
  double x = kNameLeft;
  int row = 0;
  for (const std::string& name : names) {
    const double room = kNameSample + 30 + 7.6 * static_cast<double>(name.size());
    if (x > kNameLeft && x + room > width) {
      x = kNameLeft;
      ++row;
    }
    out.emplace_back(x, row);
    x += room;
  }
  return out;
}

/// Lines and names of the groups, from `top` on.
void draw_names(Sheet& sheet, const std::vector<std::string>& names, double top) {
  std::string settings = "unset border\nunset tics\nset xrange [-1:1]\nset yrange [-1:1]\n";
  const auto places = place_names(names, sheet.width());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& [x, row] = places[i];
    const double height = 1.0 - (top + kNameRow * (row + 0.5)) / sheet.height();
    settings += fmt::format("set arrow from screen {:.5f}, screen {:.5f} to screen {:.5f}, screen {:.5f} nohead {}\n",
                            x / sheet.width(), height, (x + kNameSample) / sheet.width(), height, line_style(i));
    settings += fmt::format("set label {} at screen {:.5f}, screen {:.5f} left font ',11'\n", gnuplot_text(names[i]),
                            (x + kNameSample + 7) / sheet.width(), height);
  }
  sheet.plot({0, 0, 10, 10}, settings, "plot NaN");
}

}  // namespace

std::string write_curves_figure(const GroupCurves& curves, const std::string& title,
                                const std::filesystem::path& file) {
  constexpr double kPanelLeft = 78;
  constexpr double kPanelGap = 62;
  constexpr double kPanelsHead = 68;
  std::vector<std::string> names = group_names(curves);
  std::vector<std::string> scenes = curves.scene_names();
  const std::size_t more_groups = names.size() - std::min(names.size(), kMostCurves);
  const std::size_t more_scenes = scenes.size() - std::min(scenes.size(), kMostScenes);
  names.resize(names.size() - more_groups);
  scenes.resize(scenes.size() - more_scenes);
  const bool single = scenes.size() == 1;
  const std::size_t across = std::min(scenes.size(), kMostAcross);
  const std::size_t down = (scenes.size() + across - 1) / across;
  const double width = single ? 560 : 320;
  const double height = single ? 340 : 230;
  const double pitch = height + (single ? 0 : 92);
  const double whole = kPanelLeft + static_cast<double>(across) * (width + kPanelGap);
  const double top =
      kPanelsHead + kNameRow * (place_names(names, whole).back().second + 1) + (scenes.front().empty() ? 14 : 40);
  Sheet sheet(static_cast<int>(whole), static_cast<int>(top + static_cast<double>(down - 1) * pitch + height + 58));
  const Scale scale = metric_scale(curves);
  std::vector<double> ends;
  for (const GroupCurve& curve : curves.curves) {
    if (!curve.points.empty()) ends.push_back(curve.points.back().at);
  }
  const Scale axis = readable_scale(curves.against.unit, ends);
  const std::string better = curves.metric.better_words();
  sheet.text(title, 24, 14, 15);
  sheet.text(fmt::format("{}{}; lines: means over {}; bands: their 95 % intervals", curves.metric.name,
                         better.empty() ? "" : ", " + better, curve_units_words(curves)),
             24, 42, 10);
  draw_names(sheet, names, kPanelsHead);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    std::vector<const GroupCurve*> panel;
    std::vector<std::string> bands;
    std::vector<std::string> lines;
    double last = 0.0;
    for (const GroupCurve& curve : curves.curves) {
      const auto place = std::find(names.begin(), names.end(), curve.name());
      if (curve.scene_name() != scenes[s] || curve.points.empty() || place == names.end()) continue;
      const auto colour = static_cast<std::size_t>(place - names.begin());
      const std::string block = fmt::format("curve_{}_{}", s + 1, colour + 1);
      sheet.data(block, block_of(curve, axis.factor, scale.factor));
      bands.push_back(fmt::format("${} using 1:3:4 with filledcurves fs transparent solid 0.18 noborder lc rgb '{}'",
                                  block, kCurveColours[colour % kCurveColours.size()]));
      lines.push_back(fmt::format("${} using 1:2 with lines {}", block, line_style(colour)));
      panel.push_back(&curve);
      last = std::max(last, curve.points.back().at / axis.factor);
    }
    if (panel.empty()) continue;
    const Box box{kPanelLeft + static_cast<double>(s % across) * (width + kPanelGap),
                  top + static_cast<double>(s / across) * pitch, width, height};
    if (!scenes[s].empty())
      sheet.text(fmt::format("{}: {}", fmt::join(curves.scenes, ", "), scenes[s]), box.left, box.top - 24, 11);
    std::string settings = "set border 3 lc rgb '#555555'\nset xtics nomirror out scale 0.5 font ',10'\n";
    settings += "set ytics nomirror out scale 0.5 font ',10'\nset grid y lc rgb '#e4e4e4' lt 1\n";
    settings += fmt::format("set xrange [0:{:.6g}]\n", last) + value_range(panel, scale.factor);
    settings += fmt::format("set xlabel {} font ',11' offset 0,0.3\n", gnuplot_text(axis.title(curves.against.name)));
    if (s % across == 0)
      settings += fmt::format("set ylabel {} font ',11' offset 0.5,0\n", gnuplot_text(scale.title(curves.metric.name)));
    std::vector<std::string> clauses = std::move(bands);
    clauses.insert(clauses.end(), lines.begin(), lines.end());
    sheet.plot(box, settings, fmt::format("plot {}", fmt::join(clauses, ", \\\n  ")));
  }
  const std::string trouble = draw_picture(sheet.script(), sheet.width(), sheet.height(), file);
  if (!trouble.empty())
    throw Error(file.string(), "was not drawn: " + trouble, "a CSV, '-o NAME.csv', takes no other program",
                Error::Kind::run);
  std::string out;
  if (more_groups > 0) out += fmt::format("{} more groups", more_groups);
  if (more_scenes > 0) out += fmt::format("{}{} more scenes", out.empty() ? "" : " and ", more_scenes);
  return out.empty() ? out : out + " are not drawn: the CSV has them";
}

}  // namespace palpate
