// SPDX-License-Identifier: MIT
// A picture of several panels as a gnuplot script with its data inside: panels are placed in pixels, data stands in
// named blocks before them.
#pragma once

#include "experiment/from_above.hpp"
#include "report/colours.hpp"
#include "report/history.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// What all snapshots of a run share.
struct SceneFrame {
  Candidates candidates;
  Area area;
  double desk = 0.0;  ///< metres
};

SceneFrame scene_frame_of(const FromAbove& experiment);

/// A rectangle of the picture, pixels from its upper left corner.
struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// gnuplot's `set palette`, one line.
std::string gnuplot_palette(Palette palette);

/// The snapshot without the marks that the surface hides when it is seen from the side.
MapsAtTap in_sight(const MapsAtTap& snapshot, const SceneFrame& frame);

/// Rows of `values`, one for each candidate, the lowest y first: every cell once unless there are more than a picture
/// can show.
std::string matrix_of(const SceneFrame& frame, const Eigen::VectorXd& values);

/// gnuplot's columns that place such a matrix, in centimetres.
std::string matrix_columns(const SceneFrame& frame);

/// "x y height deviation" of the same cells in centimetres, a blank line behind each row.
std::string surface_of(const SceneFrame& frame, const Eigen::VectorXd& height, const Eigen::VectorXd& deviation);

/// The room that surfaces take when they are seen from the side, metres.
struct ZRange {
  double low = 0.0;  ///< least and largest height; the desk lies between them
  double top = 0.0;
  double above = 0.0;  ///< in the picture, from the middle of the desk to the upper edge, and to the lower one
  double below = 0.0;
};

/// What these snapshots of one experiment need to be drawn alike.
ZRange z_range_of(const std::vector<MapsAtTap>& snapshots, const SceneFrame& frame);

class FigureLayout {
 public:
  FigureLayout(int width, int height) : width_(width), height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// Without terminal and output.
  std::string script() const;

  /// gnuplot's `screen` for a point, pixels from the upper left corner.
  std::string at(double x, double y) const;
  /// gnuplot's label with its middle at a height of `y`; `style` is the rest of the command.
  std::string label(const std::string& words, double x, double y, const std::string& style) const;

  /// A named block of lines; "" makes none.
  void data(const std::string& name, const std::string& lines);
  /// The taps of a snapshot as blocks `on_NAME`, `off_NAME` and `failed_NAME` ("x y height number") and the next one as
  /// `next_NAME` ("x y"), in centimetres.
  void taps(const std::string& name, const MapsAtTap& snapshot);

  /// Text whose upper edge is at `top`; `x` is its left end or its middle. May have several lines.
  enum class Align { left, centre };
  void text(const std::string& words, double x, double top, int points, Align align = Align::left);
  /// One line along the left side of a row, its middle at `middle`.
  void upright(const std::string& words, double x, double middle, int points);

  /// The block `map` seen from above, with the taps NAME over it. The box has the aspect of the area.
  void map(const Box& box, const SceneFrame& frame, const std::string& map, const std::string& taps,
           const Colours& colours);
  /// The block `surface` in three dimensions, with the taps NAME on it, in the middle of the box.
  void surface(const Box& box, const SceneFrame& frame, const std::string& surface, const std::string& taps,
               const Colours& colours, const ZRange& z_range);
  /// The scale of the colours.
  void bar(const Box& box, const Colours& colours);
  /// What the marks mean, from `x` on, its middle at `y`.
  void legend(double x, double y, bool failed, bool next = true);

  /// A plot of any kind: lines of settings, then the clauses of one plot command.
  void plot(const Box& box, const std::string& settings, const std::string& clauses);

 private:
  std::string place(const Box& box) const;
  /// Marks over a panel, as clauses; `columns` "1:2" or "1:2:3".
  std::string marks(const std::string& taps, const std::string& columns) const;
  bool has(const std::string& block) const;

  int width_;
  int height_;
  std::string data_;
  std::string texts_;
  std::string panels_;
};

/// The step of 1, 2, 5, 10, ... by which a range of width `spread` has at most `most` tics and one more.
double tic_step(double spread, double most);

/// `value` metres as centimetres, as it stands in a block.
std::string centimetres(double value);

/// The box of a map: as wide or as high as `side`, in the aspect of the area, its upper left corner at (left, top).
Box map_box(const Area& area, double left, double top, double side);

/// A picture before it is drawn.
struct Figure {
  std::string name;
  FigureLayout layout;
};

/// Writes all scripts to `folder`, then draws them. Throws Error.
std::vector<std::filesystem::path> write_gallery(const std::filesystem::path& folder,
                                                 const std::vector<Figure>& figures);

}  // namespace palpate
