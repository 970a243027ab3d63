// SPDX-License-Identifier: MIT
#include "analysis/bootstrap.hpp"
#include "analysis/gnuplot.hpp"
#include "analysis/group_curves_report.hpp"
#include "record/files.hpp"
#include "report/figures/curves_legend.hpp"
#include "report/figures/figures.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostScenes = 12;
constexpr std::size_t kMostCurves = 16;  ///< largest number of curves per panel

// Lengths in points (1/72 inch).
constexpr double kAxisRoom = 40;         ///< width left of the first panel, for numbers and title of the axis
constexpr double kPanelGap = 14;         ///< width between panels; only the first panel of a row has numbers
constexpr double kNumbersRoom = 14;      ///< height below a panel, for numbers
constexpr double kLeastPanelWidth = 85;  ///< least width of a panel; rows have fewer panels if necessary

/// Returns the names of the groups in the order of the sweep; a group has the same style in all panels.
std::vector<std::string> group_names(const GroupCurves& curves) {
  std::vector<std::string> out;
  for (const GroupCurve& curve : curves.curves) {
    std::string name = curve.name();
    if (!curve.points.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

/// Returns the interval to draw at a point. If all values are equal, there is no interval, and the band shrinks to the
/// mean.
std::optional<MeanInterval> drawn_interval(const MeanEstimate& mean) {
  if (mean.interval || mean.count == 0 || mean.clusters < kLeastForInterval) return mean.interval;
  return MeanInterval{mean.mean, mean.mean};
}

/// Range of an axis. The range begins at 0 if 0 is near the values.
struct AxisRange {
  double low = 0.0;
  double high = 0.0;

  AxisRange(double least, double most) {
    constexpr double kNear = 0.25;  // 0 is near if its distance is at most this share of the range
    constexpr double kRoom = 0.04;
    const double room = std::max(most - least, std::max(1e-9, 1e-3 * std::abs(most)));
    low = least >= 0.0 && least <= kNear * room ? 0.0 : least - kRoom * room;
    high = most + kRoom * room;
  }

  /// Returns gnuplot's commands for the axis `name` with this length in points. If `whole` is set, all tics are whole
  /// numbers.
  std::string settings(char name, double length, bool whole) const {
    constexpr double kPerTic = 18;
    double step = tic_step(high - low, std::max(2.0, length / kPerTic));
    if (whole) step = std::max(1.0, step);
    return fill_template("curves_axis", name, low, high, step);
  }
};

/// Returns the range of the values of all curves, the same for all panels. The range covers all means, but only a part
/// of wide intervals, because intervals after the first taps may be very wide. If no mean is negative, the range has no
/// negative values.
AxisRange value_range(const std::vector<const GroupCurve*>& curves, double factor) {
  std::vector<double> means;
  std::vector<double> ends;
  for (const GroupCurve* curve : curves) {
    for (const CurvePoint& point : curve->points) {
      if (point.mean.count == 0) continue;
      means.push_back(point.mean.mean / factor);
      const auto interval = drawn_interval(point.mean);
      ends.push_back(interval ? interval->low / factor : means.back());
      ends.push_back(interval ? interval->high / factor : means.back());
    }
  }
  if (means.empty()) return {0.0, 1.0};
  const auto [low, high] = std::minmax_element(means.begin(), means.end());
  const auto [least, most] = std::minmax_element(ends.begin(), ends.end());
  const double room = 0.5 * (*high - *low);
  const double below = std::max(*least, *low - room);
  return {*low >= 0.0 ? std::max(below, 0.0) : below, std::min(*most, *high + room)};
}

/// Returns one line "at mean low high" per point, in the units of the axes; NaN for a missing value.
std::string block_of(const GroupCurve& curve, double axis, double factor) {
  std::string out;
  const auto number = [&](double value) { return fmt::format("{:.6g}", value / factor); };
  for (const CurvePoint& point : curve.points) {
    const auto ends = drawn_interval(point.mean);
    out += fmt::format("{:.6g} {} {} {}\n", point.at / axis, point.mean.count > 0 ? number(point.mean.mean) : "NaN",
                       ends ? number(ends->low) : "NaN", ends ? number(ends->high) : "NaN");
  }
  return out;
}

/// Returns the lines of a panel's title, such as "scene: ring". Leaves out the names of the keys if they do not fit.
std::vector<std::string> panel_title(const GroupCurves& curves, const std::string& scene, double width) {
  if (scene.empty()) return {};
  const std::string whole = fmt::format("{}: {}", fmt::join(curves.scenes, ", "), scene);
  return lines_within(width_of_line(whole) <= width ? whole : scene, width);
}

/// Returns comments for the script: title and text of a caption.
std::string caption_of(const GroupCurves& curves, const std::string& title) {
  const std::string better = curves.metric.better_words();
  return fmt::format(
      "# {}\n# {} against {}{}.\n# Lines: means over {}. Bands: their 95 % intervals.\n# Edit a copy: 'palpate curves' "
      "overwrites this file.\n",
      one_line(title), curves.metric.words(), curves.against.words(), better.empty() ? "" : "; " + better,
      curve_units_words(curves));
}

/// Returns the header of the script for `file`, and the headers for the other formats as comments.
std::string headers_of(const FigureLayout& layout, const fs::path& file) {
  const auto header = [&](const fs::path& one) {
    const fs::path name = one.filename();
    return picture_header(layout.width(), layout.height(), name, name.string(), PictureUnit::point);
  };
  std::string out = header(file);
  for (const char* const other : {".pdf", ".png", ".svg"}) {
    if (file.extension() == other) continue;
    std::istringstream lines(header(fs::path(file).replace_extension(other)));
    for (std::string line; std::getline(lines, line);) out += "# " + line + "\n";
  }
  return out;
}

/// The drawn groups and scenes of a figure, and the positions of the panels.
struct PanelGrid {
  std::vector<std::string> names;   ///< drawn groups
  std::vector<std::string> scenes;  ///< drawn scenes, one panel each
  std::string left_out;             ///< text about groups and scenes that are not drawn
  std::vector<LegendEntry> legend;
  std::vector<std::string> y_title;
  double left = 0.0;       ///< left edge of the first panel
  std::size_t across = 1;  ///< number of panels side by side
  double top = 0.0;        ///< upper edge of the first panel with its title
  double head = 0.0;       ///< height of a panel's title
  double panel_width = 0.0;
  double panel_height = 0.0;
  double pitch = 0.0;  ///< distance between rows
  double width = 0.0;
  double height = 0.0;

  Box box(std::size_t panel) const {
    const std::size_t row = panel / across;
    return {left + static_cast<double>(panel % across) * (panel_width + kPanelGap),
            top + head + static_cast<double>(row) * pitch, panel_width, panel_height};
  }
};

PanelGrid grid_of(const GroupCurves& curves, const std::string& y_title, double width) {
  PanelGrid out;
  out.width = width;
  out.names = group_names(curves);
  out.scenes = curves.scene_names();
  const std::size_t more_groups = out.names.size() - std::min(out.names.size(), kMostCurves);
  const std::size_t more_scenes = out.scenes.size() - std::min(out.scenes.size(), kMostScenes);
  out.names.resize(out.names.size() - more_groups);
  out.scenes.resize(out.scenes.size() - more_scenes);
  if (more_groups > 0) out.left_out += fmt::format("{} more groups", more_groups);
  if (more_scenes > 0) out.left_out += fmt::format("{}{} more scenes", more_groups > 0 ? " and " : "", more_scenes);
  if (!out.left_out.empty()) out.left_out += " are not drawn: the CSV has them";

  // The panels are distributed evenly over the rows. The title of the y axis is to the left of all rows. It has several
  // lines if the rows are short. `pairs` is the width of all panels of a row, each with the gap after it.
  const double pairs = width - kAxisRoom - kEndRoom + kPanelGap;
  const std::size_t most = std::max<std::size_t>(1, static_cast<std::size_t>(pairs / (kLeastPanelWidth + kPanelGap)));
  const std::size_t down = (out.scenes.size() + most - 1) / most;
  out.across = (out.scenes.size() + down - 1) / down;
  out.panel_height = std::clamp(0.72 * (pairs / static_cast<double>(out.across) - kPanelGap), 80.0, 170.0);
  out.pitch = out.panel_height + kNumbersRoom + 4;
  constexpr double kLegendAndTitle = 30;
  out.y_title = lines_within(y_title, static_cast<double>(down) * out.pitch + kLegendAndTitle);
  if (out.y_title.size() > 1) out.y_title = lines_within(y_title, 0.6 * width_of_line(y_title));
  out.left = kAxisRoom + kLineHeight * static_cast<double>(out.y_title.size() - 1);
  out.panel_width = (pairs + kAxisRoom - out.left) / static_cast<double>(out.across) - kPanelGap;
  std::size_t lines = 0;
  for (const std::string& scene : out.scenes)
    lines = std::max(lines, panel_title(curves, scene, out.panel_width).size());
  out.head = kLineHeight * static_cast<double>(lines) + 3;
  out.pitch += out.head;
  out.legend = place_names(out.names, out.left, width);
  out.top = 8 + kLineHeight * static_cast<double>(out.legend.back().row + out.legend.back().lines.size());
  out.height = std::ceil(out.top + static_cast<double>(down) * out.pitch + kLineHeight);
  return out;
}

/// Clauses of gnuplot's plot command that draw bands and lines.
struct PlotClauses {
  std::vector<std::string> bands;
  std::vector<std::string> lines;

  void add(const std::string& block, const LineStyle& style, std::size_t points) {
    constexpr std::size_t kMarksOfALine = 8;
    bands.push_back(fmt::format("${} using 1:3:4 with filledcurves fs transparent solid 0.18 noborder lc rgb '{}'",
                                block, style.colour));
    lines.push_back(fmt::format("${} using 1:2 with linespoints {} {} pi {}", block, style.line, style.point,
                                (points + kMarksOfALine - 1) / kMarksOfALine));
  }

  /// Returns a plot command that draws all bands, then all lines.
  std::string plot() const {
    if (bands.empty()) return "plot NaN";
    return fmt::format("plot {}, \\\n  {}", fmt::join(bands, ", \\\n  "), fmt::join(lines, ", \\\n  "));
  }
};

/// The drawn curves, with the units and axes that all panels share.
struct DrawnCurves {
  std::vector<const GroupCurve*> curves;
  DisplayScale axis;
  DisplayScale value;
  AxisRange x;
  AxisRange y;
};

std::size_t place_in(const std::vector<std::string>& all, const std::string& one) {
  return static_cast<std::size_t>(std::find(all.begin(), all.end(), one) - all.begin());
}

DrawnCurves drawn_curves(const GroupCurves& curves, const PanelGrid& grid) {
  std::vector<const GroupCurve*> drawn;
  std::vector<double> places;
  for (const GroupCurve& curve : curves.curves) {
    if (place_in(grid.names, curve.name()) == grid.names.size() ||
        place_in(grid.scenes, curve.scene_name()) == grid.scenes.size())
      continue;
    drawn.push_back(&curve);
    for (const CurvePoint& point : curve.points) places.push_back(point.at);
  }
  const DisplayScale axis = readable_scale(curves.against.unit, places);
  const DisplayScale value = metric_scale(curves);
  const auto [first, last] = std::minmax_element(places.begin(), places.end());
  return {drawn, axis, value, AxisRange(*first / axis.factor, *last / axis.factor), value_range(drawn, value.factor)};
}

/// Returns the labels of a panel: its title, and the titles of axes on panels at the edges.
std::string panel_labels(const FigureLayout& layout, const GroupCurves& curves, const DrawnCurves& drawn,
                         const PanelGrid& grid, std::size_t panel) {
  const Box box = grid.box(panel);
  std::string out;
  double y = box.top - grid.head + 0.5 * kLineHeight;
  for (const std::string& line : panel_title(curves, grid.scenes[panel], box.width)) {
    out += layout.label(line, box.left, y, "left");
    y += kLineHeight;
  }
  if (panel + grid.across >= grid.scenes.size())
    out += layout.label(drawn.axis.title(curves.against.words()), box.left + 0.5 * box.width,
                        box.top + box.height + kNumbersRoom + 0.6 * kLineHeight, "center");
  if (panel > 0) return out;
  const Box below = grid.box(grid.scenes.size() - 1);
  for (std::size_t line = 0; line < grid.y_title.size(); ++line)
    out += layout.label(grid.y_title[line], 7 + kLineHeight * static_cast<double>(line),
                        0.5 * (box.top + below.top + below.height), "center rotate by 90");
  return out;
}

void draw_panel(FigureLayout& layout, const GroupCurves& curves, const DrawnCurves& drawn, const PanelGrid& grid,
                std::size_t panel) {
  const Box box = grid.box(panel);
  PlotClauses clauses;
  for (const GroupCurve* curve : drawn.curves) {
    if (curve->scene_name() != grid.scenes[panel] || curve->points.empty()) continue;
    const std::size_t group = place_in(grid.names, curve->name());
    const std::string block = fmt::format("curve_{}_{}", panel + 1, group + 1);
    layout.data(block, block_of(*curve, drawn.axis.factor, drawn.value.factor));
    clauses.add(block, line_style(group), curve->points.size());
  }
  std::string settings = fill_template("group_curves") + panel_labels(layout, curves, drawn, grid, panel);
  settings += drawn.x.settings('x', box.width, curves.against.name == kAgainstTaps);
  settings += drawn.y.settings('y', box.height, false);
  if (panel % grid.across > 0) settings += "set ytics format ''\n";
  layout.plot(box, settings, clauses.plot());
}

}  // namespace

std::string write_curves_figure(const GroupCurves& curves, const std::string& title, double width,
                                const fs::path& file) {
  constexpr double kPointsPerMetre = 72.0 / 0.0254;
  const PanelGrid grid =
      grid_of(curves, metric_scale(curves).title(curves.metric.words()), std::floor(width * kPointsPerMetre));
  const DrawnCurves drawn = drawn_curves(curves, grid);
  FigureLayout layout(static_cast<int>(grid.width), static_cast<int>(grid.height));
  draw_legend(layout, grid.legend);
  for (std::size_t panel = 0; panel < grid.scenes.size(); ++panel) draw_panel(layout, curves, drawn, grid, panel);
  const std::string script = layout.script();
  write_file(fs::path(file).replace_extension(".gnuplot"),
             caption_of(curves, title) + headers_of(layout, file) + script);
  const std::string trouble = draw_picture(script, layout.width(), layout.height(), file, PictureUnit::point);
  if (!trouble.empty())
    throw Error(file.string(), "was not drawn: " + trouble,
                "write a CSV with '-o NAME.csv', which needs no other program", Error::Kind::run);
  return grid.left_out;
}

}  // namespace palpate
