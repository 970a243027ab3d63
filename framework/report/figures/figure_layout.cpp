// SPDX-License-Identifier: MIT
#include "report/figures/figure_layout.hpp"

#include "analysis/gnuplot.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostDrawn = 128;  ///< largest number of cells along a side; a panel has about twice as many pixels

constexpr const char* kStar = "#e6007e";

/// Returns gnuplot's command for a star with five rays of length `ray` about (next_x, next_y). The star is a polygon,
/// because the shape of a character depends on the font. The star may extend beyond the edge of a map.
std::string star_at(double ray) {
  std::string out = "set object 1 polygon";
  for (int i = 0; i <= 10; ++i) {
    const double radius = ray * (i % 2 == 0 ? 1.0 : 0.42);
    const double angle = kPi * (0.5 + i / 5.0);
    out += fmt::format("{} next_x+({:.4f}),next_y+({:.4f})", i == 0 ? " from" : " to", radius * std::cos(angle),
                       radius * std::sin(angle));
  }
  return out + fmt::format(" front noclip fc rgb '{}' fs solid border lc rgb 'white' lw 1.3\n", kStar);
}

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN"; }

std::string axis(char name, double length) {
  return fill_template("map_axis", name, 100.0 * length, 100.0 * length > 12.0 ? "5" : "autofreq");
}

std::string colour_range(const ColourScale& colours) {
  return gnuplot_palette(colours.palette) + fmt::format("set cbrange [{}:{}]\n{}", number(colours.low),
                                                        number(colours.high),
                                                        colours.logarithmic ? "set logscale cb\n" : "");
}

/// Returns the number of drawn cells along a side, at least two, because gnuplot's images need two.
int drawn(int count) { return std::clamp(count, 2, kMostDrawn); }

/// Concatenates `cell`(candidate, column, row) over the drawn cells, with a line end after each row.
template <class CellText>
std::string rows_of(const SceneFrame& frame, const CellText& cell) {
  const CandidateGrid& all = frame.candidates;
  std::string out;
  for (int row = 0; row < drawn(all.rows); ++row) {
    const int from_row = static_cast<int>((row + 0.5) * all.rows / drawn(all.rows));
    for (int column = 0; column < drawn(all.columns); ++column) {
      const int from_column = static_cast<int>((column + 0.5) * all.columns / drawn(all.columns));
      out += cell(from_row * all.columns + from_column, column, row);
    }
    out += "\n";
  }
  return out;
}

// Direction of view of surfaces: tilt from the vertical, and rotation about the vertical.
constexpr double kTiltDegrees = 60.0;
constexpr double kTurnDegrees = 32.0;
constexpr double kTilt = kTiltDegrees * kPi / 180.0;
constexpr double kTurn = kTurnDegrees * kPi / 180.0;
constexpr int kBarSteps = 128;

}  // namespace

std::string gnuplot_palette(Palette palette) {
  std::string out = "set palette defined (";
  const std::vector<std::string>& stops = palette_stops(palette);
  for (std::size_t i = 0; i < stops.size(); ++i) out += fmt::format("{}{} '{}'", i > 0 ? ", " : "", i, stops[i]);
  return out + ")\n";
}

SceneFrame scene_frame_of(const Experiment& experiment) {
  return {grid_of(experiment.belief().candidates()), experiment.scene().area(), experiment.scene().desk()};
}

double tic_step(double spread, double most) {
  const double power = std::pow(10.0, std::floor(std::log10(spread / most)));
  const double coarse = spread / most / power;
  return power * (coarse > 5.0 ? 10.0 : coarse > 2.0 ? 5.0 : coarse > 1.0 ? 2.0 : 1.0);
}

std::string centimetres(double value) { return fmt::format("{:.10g}", 100.0 * value); }

Box map_box(const Area& area, double left, double top, double side) {
  const double scale = side / std::max(area.width, area.depth);
  return {left, top, scale * area.width, scale * area.depth};
}

ZRange z_range_of(const std::vector<MapsAtTap>& snapshots, const SceneFrame& frame) {
  // Returns how far a point is above the middle of the desk in the picture after gnuplot's parallel projection, metres.
  const auto up = [&](double x, double y, double height) {
    const double back = (y - 0.5 * frame.area.depth) * std::cos(kTurn) - (x - 0.5 * frame.area.width) * std::sin(kTurn);
    return back * std::cos(kTilt) + (height - frame.desk) * std::sin(kTilt);
  };
  const double far = up(0.0, frame.area.depth, frame.desk);
  ZRange out{frame.desk, frame.desk + 0.01, far, far};
  const auto include = [&](double x, double y, double height) {
    out.low = std::min(out.low, height);
    out.top = std::max(out.top, height);
    out.above = std::max(out.above, up(x, y, height));
    out.below = std::max(out.below, -up(x, y, height));
  };
  for (const MapsAtTap& one : snapshots) {
    for (Eigen::Index i = 0; i < one.surface.size(); ++i)
      include(frame.candidates.points(i, 0), frame.candidates.points(i, 1), one.surface(i));
    for (const TapMark& mark : one.marks) include(mark.x, mark.y, mark.height);
  }
  return out;
}

MapsAtTap without_hidden_taps(const MapsAtTap& snapshot, const SceneFrame& frame) {
  const Area& area = frame.area;
  const CandidateGrid& candidates = frame.candidates;
  const double step = 0.5 * std::min(area.width / candidates.columns, area.depth / candidates.rows);
  // The surface hides a tap only if it rises above the line of sight by more than this margin, because a part of the
  // mark extends above the surface.
  const double height = snapshot.surface.maxCoeff() - snapshot.surface.minCoeff();
  const double margin = 0.06 * height;
  const auto hidden = [&](const TapMark& mark) {
    for (double way = step;; way += step) {
      const double x = mark.x + way * std::sin(kTurn);
      const double y = mark.y - way * std::cos(kTurn);
      const double z = mark.height + margin + way * std::cos(kTilt) / std::sin(kTilt);
      if (x < 0.0 || x > area.width || y < 0.0 || y > area.depth) return false;
      if (snapshot.surface(candidates.nearest(x, y, area)) > z) return true;
    }
  };
  MapsAtTap out = snapshot;
  out.marks.erase(std::remove_if(out.marks.begin(), out.marks.end(), hidden), out.marks.end());
  return out;
}

std::string matrix_of(const SceneFrame& frame, const Eigen::VectorXd& values) {
  return rows_of(frame, [&](Eigen::Index candidate, int column, int /*row*/) {
    return (column > 0 ? " " : "") + number(values(candidate));
  });
}

std::string matrix_columns(const SceneFrame& frame) {
  return fmt::format("({0} * (column(1) + 0.5)):({1} * (column(2) + 0.5)):3",
                     100.0 * frame.area.width / drawn(frame.candidates.columns),
                     100.0 * frame.area.depth / drawn(frame.candidates.rows));
}

std::string surface_of(const SceneFrame& frame, const Eigen::VectorXd& height, const Eigen::VectorXd& deviation) {
  return rows_of(frame, [&](Eigen::Index candidate, int column, int row) {
    const double x = (column + 0.5) * frame.area.width / drawn(frame.candidates.columns);
    const double y = (row + 0.5) * frame.area.depth / drawn(frame.candidates.rows);
    return fmt::format("{} {} {} {}\n", number(100.0 * x), number(100.0 * y), number(100.0 * height(candidate)),
                       number(100.0 * deviation(candidate)));
  });
}

bool FigureLayout::has(const std::string& block) const {
  return data_.find("$" + block + " << END\n") != std::string::npos;
}

void FigureLayout::data(const std::string& name, const std::string& lines) {
  if (lines.empty()) return;
  data_ += fmt::format("${} << END\n{}END\n", name, lines);
}

void FigureLayout::taps(const std::string& name, const MapsAtTap& snapshot) {
  constexpr const char* kKinds[] = {"on_", "off_", "failed_"};  // prefixes in the order of TapMark::Kind
  std::string lines[std::size(kKinds)];
  for (const TapMark& mark : snapshot.marks)
    lines[static_cast<std::size_t>(mark.kind)] +=
        fmt::format("{} {} {} {}\n", centimetres(mark.x), centimetres(mark.y), centimetres(mark.height), mark.tap);
  for (std::size_t i = 0; i < std::size(kKinds); ++i) data(kKinds[i] + name, lines[i]);
  if (snapshot.next)
    data("next_" + name, centimetres(snapshot.next->target().x) + " " + centimetres(snapshot.next->target().y) + "\n");
}

void FigureLayout::text(const std::string& words, double x, double top, int points, Align align) {
  double y = top + 0.5 * 1.35 * points;
  std::size_t begin = 0;
  while (begin <= words.size()) {
    const std::size_t end = std::min(words.find('\n', begin), words.size());
    texts_ += label(words.substr(begin, end - begin), x, y,
                    fmt::format("{} font ',{}'", align == Align::left ? "left" : "center", points));
    y += 1.6 * points;
    begin = end + 1;
  }
}

void FigureLayout::vertical_text(const std::string& words, double x, double middle, int points) {
  texts_ += label(words, x, middle, fmt::format("center rotate by 90 font ',{}'", points));
}

std::string FigureLayout::at(double x, double y) const {
  return fmt::format("screen {:.5f}, screen {:.5f}", x / width_, 1.0 - y / height_);
}

std::string FigureLayout::label(const std::string& words, double x, double y, const std::string& style) const {
  return fmt::format("set label {} at {} {}\n", gnuplot_text(words), at(x, y), style);
}

std::string FigureLayout::place(const Box& box) const {
  return fill_template("margins", box.left / width_, (box.left + box.width) / width_, 1.0 - box.top / height_,
                       1.0 - (box.top + box.height) / height_);
}

void FigureLayout::plot(const Box& box, const std::string& settings, const std::string& clauses) {
  panels_ += "\nreset\nunset key\n" + place(box) + std::exchange(texts_, "") + settings + clauses + "\n";
}

std::string FigureLayout::marks(const std::string& taps, const std::string& columns) const {
  std::string out;
  const auto add = [&](const std::string& kind, const std::string& under, const std::string& over) {
    if (!has(kind + "_" + taps)) return;
    for (const std::string& style : {under, over})
      out += fmt::format(", \\\n  ${}_{} using {} with points {}", kind, taps, columns, style);
  };
  add("failed", "pt 4 ps 1.3 lw 4.5 lc rgb 'white'", "pt 4 ps 1.3 lw 2 lc rgb '#d55e00'");
  add("off", "pt 2 ps 1.15 lw 4.5 lc rgb 'white'", "pt 2 ps 1.05 lw 2 lc rgb 'black'");
  add("on", "pt 7 ps 1.45 lc rgb 'white'", "pt 7 ps 1.05 lc rgb 'black'");
  return out;
}

void FigureLayout::map(const Box& box, const SceneFrame& frame, const std::string& map, const std::string& taps,
                       const ColourScale& colours) {
  const Area& area = frame.area;
  std::string settings = axis('x', area.width) + axis('y', area.depth) + colour_range(colours) + fill_template("map");
  if (const std::string next = "next_" + taps; has(next))
    settings += fill_template("next_tap", next) + star_at(100.0 * 0.042 * std::max(area.width, area.depth));
  plot(box, settings,
       fmt::format("plot ${} matrix using {} with image", map, matrix_columns(frame)) + marks(taps, "1:2"));
}

void FigureLayout::surface(const Box& box, const SceneFrame& frame, const std::string& surface, const std::string& taps,
                           const ColourScale& colours, const ZRange& z_range) {
  const Area& area = frame.area;
  const double wide = area.width * std::cos(kTurn) + area.depth * std::sin(kTurn);
  const double scale = std::min(box.width / wide, box.height / (z_range.above + z_range.below));  // pixels per metre
  // height of the desk in the picture
  const double middle = box.top + 0.5 * box.height + 0.5 * scale * (z_range.above - z_range.below);
  const double lift = scale * (0.5 * (z_range.low + z_range.top) - frame.desk) * std::sin(kTilt);
  // gnuplot scales the longer side of the area to the shorter side of the rectangle between the margins, and centres
  // the area in it.
  const double side = scale * std::max(area.width, area.depth);
  const Box inner{box.left + 0.5 * (box.width - side), middle - lift - 0.5 * side, side, side};
  std::string settings = axis('x', area.width) + axis('y', area.depth) + colour_range(colours);
  settings += fill_template("surface", centimetres(z_range.low), centimetres(z_range.top), centimetres(frame.desk),
                            kTiltDegrees, kTurnDegrees);
  plot(inner, settings, fmt::format("splot ${} using 1:2:3:4 with pm3d", surface) + marks(taps, "1:2:3"));
}

void FigureLayout::bar(const Box& box, const ColourScale& colours) {
  std::string settings = gnuplot_palette(colours.palette) +
                         fill_template("colour_bar", kBarSteps - 0.5, number(colours.low), number(colours.high));
  if (colours.logarithmic) settings += "set logscale y2\n";
  if (!colours.label.empty()) vertical_text(colours.label, box.left + box.width + 68, box.top + 0.5 * box.height, 10);
  plot(box, settings, "plot $bar matrix using 1:2:3 with image");
}

void FigureLayout::legend(double x, double y, bool failed, bool next) {
  std::string settings = fill_template("frameless");
  const auto entry = [&](const std::string& style, const std::string& words, double width) {
    if (!style.empty()) settings += label("", x, y, "point " + style + " front");
    settings += label(words, x + 14, y, "left font ',11'");
    x += width;
  };
  entry("pt 7 ps 1.2 lc rgb 'black'", "tap on the object", 165);
  entry("pt 2 ps 1.1 lw 2 lc rgb 'black'", "tap on the desk", 150);
  if (failed) entry("pt 4 ps 1.3 lw 2 lc rgb '#d55e00'", "failed tap", 115);
  const Box star{x - 9, y - 9, 18, 18};
  if (next) {
    entry("", "next tap", 0);
    settings += "next_x = 0\nnext_y = 0\n" + star_at(1.0);
  }
  plot(star, settings, "plot NaN");
}

std::string FigureLayout::script() const {
  std::string bar;
  for (int i = 0; i < kBarSteps; ++i) bar += fmt::format("{0} {0}\n", i);
  const bool has_bar = panels_.find("$bar ") != std::string::npos;
  const std::string out = (has_bar ? fmt::format("$bar << END\n{}END\n", bar) : "") + data_ + "set multiplot\n" +
                          panels_ + "unset multiplot\nset output\n";
  // In the C locale, gnuplot warns about any `set encoding`. Scripts in ASCII therefore set no encoding.
  const bool is_ascii =
      std::all_of(out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  return (is_ascii ? "" : "set encoding utf8\n") + out;
}

std::vector<fs::path> write_figures(const fs::path& folder, const std::vector<Figure>& figures) {
  make_inner_folder(folder);
  std::error_code failed;
  for (const auto& [name, layout] : figures) {
    // Removes an older picture, which would not match the new script.
    fs::remove(folder / (name + ".png"), failed);
    write_file(folder / (name + ".gnuplot"),
               picture_header(layout.width(), layout.height(), name + ".png", name + ".png") + layout.script());
  }
  std::vector<fs::path> pictures;
  for (const auto& [name, layout] : figures) {
    pictures.push_back(folder / (name + ".png"));
    const std::string trouble = draw_picture(layout.script(), layout.width(), layout.height(), pictures.back());
    if (trouble.empty()) continue;
    throw Error(pictures.back().string(), "was not drawn: " + trouble,
                fmt::format("run 'gnuplot {}.gnuplot' in that folder to draw it later", name), Error::Kind::run);
  }
  return pictures;
}

}  // namespace palpate
