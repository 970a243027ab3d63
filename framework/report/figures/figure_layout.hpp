// SPDX-License-Identifier: MIT
// A picture of several panels as a gnuplot script. Positions of panels are in pixels, or in points in figures for
// print. The data of the panels is in named blocks at the beginning of the script.
#pragma once

#include "experiment/experiment.hpp"
#include "report/colours.hpp"
#include "report/history.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Grid of candidates, area and desk, which are the same for all taps of a run.
struct SceneFrame {
  CandidateGrid candidates;
  Area area;
  double desk = 0.0;  ///< height of the desk, metres
};

SceneFrame scene_frame_of(const Experiment& experiment);

/// A rectangle in the picture. Positions are in pixels from the upper left corner of the picture.
struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// Returns gnuplot's command `set palette`, one line.
std::string gnuplot_palette(Palette palette);

/// Returns `snapshot` without the marks of the taps that the surface hides in the view from the side.
MapsAtTap without_hidden_taps(const MapsAtTap& snapshot, const SceneFrame& frame);

/// Returns `values`, one per candidate, as rows of a matrix, beginning with the lowest y. If the grid has more cells
/// than a picture can show, rows and columns are left out.
std::string matrix_of(const SceneFrame& frame, const Eigen::VectorXd& values);

/// Returns the columns for gnuplot's `using` for a matrix from matrix_of(): x and y in centimetres, and the value.
std::string matrix_columns(const SceneFrame& frame);

/// Returns lines "x y height deviation" of the cells of matrix_of(), in centimetres, with a blank line after each row.
std::string surface_of(const SceneFrame& frame, const Eigen::VectorXd& height, const Eigen::VectorXd& deviation);

/// Extent of surfaces in the view from the side, metres.
struct ZRange {
  double low = 0.0;  ///< `low` and `top`: least and largest height of desk, surfaces and marks
  double top = 0.0;
  /// `above` and `below`: extent of the picture above and below the middle of the desk, after projection
  double above = 0.0;
  double below = 0.0;
};

/// Returns the common extent of the surfaces of one experiment, so that all panels have the same scale.
ZRange z_range_of(const std::vector<MapsAtTap>& snapshots, const SceneFrame& frame);

class FigureLayout {
 public:
  FigureLayout(int width, int height) : width_(width), height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// Returns the script, which does not set terminal and output.
  std::string script() const;

  /// Returns gnuplot's `screen` coordinates of a point in pixels from the upper left corner.
  std::string at(double x, double y) const;
  /// Returns gnuplot's command for a label that is centred vertically at `y`. `style` is the rest of the command.
  std::string label(const std::string& words, double x, double y, const std::string& style) const;

  /// Adds a named block of data. Adds nothing if `lines` is empty.
  void data(const std::string& name, const std::string& lines);
  /// Adds the taps as blocks `on_NAME`, `off_NAME` and `failed_NAME` ("x y height number"), and the next tap as
  /// `next_NAME` ("x y"), in centimetres.
  void taps(const std::string& name, const MapsAtTap& snapshot);

  /// Adds text of one or more lines with its upper edge at `top`. `x` is the left end of the lines, or their middle
  /// with Align::centre.
  enum class Align { left, centre };
  void text(const std::string& words, double x, double top, int points, Align align = Align::left);
  /// Adds one vertical line of text with its middle at `middle`, left of a row of panels.
  void vertical_text(const std::string& words, double x, double middle, int points);

  /// Adds the block `map` as a map seen from above, with the taps `taps` on it. The box has the aspect ratio of the
  /// area.
  void map(const Box& box, const SceneFrame& frame, const std::string& map, const std::string& taps,
           const ColourScale& colours);
  /// Adds the block `surface` in three dimensions, with the taps `taps` on it. The surface is in the middle of the box.
  void surface(const Box& box, const SceneFrame& frame, const std::string& surface, const std::string& taps,
               const ColourScale& colours, const ZRange& z_range);
  /// Adds the colour bar.
  void bar(const Box& box, const ColourScale& colours);
  /// Adds the legend of the marks. The legend begins at `x`, and its vertical middle is at `y`.
  void legend(double x, double y, bool failed, bool next = true);

  /// Adds a plot that consists of lines of settings and one plot command.
  void plot(const Box& box, const std::string& settings, const std::string& clauses);

 private:
  std::string place(const Box& box) const;
  /// Returns the clauses that draw marks of taps over a panel; `columns` is "1:2" or "1:2:3".
  std::string marks(const std::string& taps, const std::string& columns) const;
  bool has(const std::string& block) const;

  int width_;
  int height_;
  std::string data_;
  std::string texts_;
  std::string panels_;
};

/// Returns the least step among 1, 2 and 5 times a power of ten for which a range of width `spread` has at most `most`
/// + 1 tics.
double tic_step(double spread, double most);

/// Returns a length in metres as centimetres, for a block of data.
std::string centimetres(double value);

/// Returns the box of a map with its upper left corner at (left, top). The longer side of the box is `side`. The box
/// has the aspect ratio of the area.
Box map_box(const Area& area, double left, double top, double side);

/// A picture that is not drawn yet.
struct Figure {
  std::string name;
  FigureLayout layout;
};

/// Writes all scripts to `folder` and then draws their pictures. Throws Error if a picture cannot be drawn.
std::vector<std::filesystem::path> write_figures(const std::filesystem::path& folder,
                                                 const std::vector<Figure>& figures);

}  // namespace palpate
