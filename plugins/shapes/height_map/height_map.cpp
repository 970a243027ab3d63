// SPDX-License-Identifier: MIT
// An object that is given by heights on a grid, for example from a depth camera, a profilometer or a terrain model. The
// surface of each cell consists of two flat triangles, so intersections with lines are exact up to rounding.
#include "grid.hpp"
#include "shapes/mesh/options.hpp"
#include "shapes/solid.hpp"

#include <palpate/error.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace palpate::shapes {

using Eigen::Index;

struct HeightMapShapeOptions : Options {
  std::string file;
  double unit = 0.001;
  double spacing = 0.001;
  std::string checksum;

  void list(Fields& fields) override {
    fields.text(file, Field("file",
                            "CSV, NPY or PNG file (8 or 16 bits, grey). The first row is at the largest y. A relative "
                            "path starts in the working folder or in the folder of the config")
                          .needed()
                          .names_file()
                          .not_identifying());
    fields.real(unit, Field("unit", "height of the value 1 in the file").in(Unit::metre).above(0).needed());
    fields.real(spacing, Field("spacing", "distance between neighbouring values of the grid, along x and along y")
                             .in(Unit::metre)
                             .above(0)
                             .needed());
    list_checksum(file, checksum, fields);
  }
};

class HeightMapShape final : public Shape {
 public:
  using Options = HeightMapShapeOptions;
  HeightMapShape(const Options& options, const Context&) : spacing_(options.spacing) {
    const Grid all = read_grid(read_file(options.file, options.checksum), options.file);
    // Rows and columns of zeros around the object are removed, because they are desk. The nearest ones stay, because
    // the object slopes down to them.
    const auto [first_row, rows] = range_of(all.rowwise().maxCoeff() > 0.0);
    const auto [first_column, columns] = range_of((all.colwise().maxCoeff() > 0.0).transpose());
    heights_ = options.unit * all.block(first_row, first_column, rows, columns).colwise().reverse();
    highest_ = heights_.maxCoeff();
    half_length_ = spacing_ * static_cast<double>(columns - 1) / 2;
    half_width_ = spacing_ * static_cast<double>(rows - 1) / 2;
    constexpr double kLargest = 2.0;
    const double size = std::max({2 * half_length_, 2 * half_width_, highest_});
    if (size > kLargest)
      throw Error(options.file, "is " + std::to_string(size) + " m large, at most 2 m are allowed",
                  "check unit and spacing");
  }

  double first_intersection(const Line& line) const override {
    double out = kInfinity;
    visit(line, [&](const LineInterval& one) { return out = one.begin, false; });
    return out;
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    std::vector<LineInterval> out;
    visit(line, [&](const LineInterval& one) { return out.push_back(one), true; });
    return out;
  }

  double support(const Vector3d& direction) const override {
    double out = -kInfinity;
    for (Index row = 0; row < heights_.rows(); ++row) {
      for (Index column = 0; column < heights_.cols(); ++column) {
        const double up = std::max(0.0, direction.z() * heights_(row, column));
        out = std::max(out, direction.x() * x_of(column) + direction.y() * y_of(row) + up);
      }
    }
    return out;
  }

 private:
  /// Returns a range as first index and length. It begins one entry before the first true entry and ends one entry
  /// after the last, if these entries exist.
  template <class Holds>
  static std::pair<Index, Index> range_of(const Holds& holds) {
    Index first = holds.size();
    Index last = -1;
    for (Index i = 0; i < holds.size(); ++i) {
      if (!holds(i)) continue;
      first = std::min(first, i);
      last = i;
    }
    first = std::max<Index>(0, first - 1);
    last = std::min<Index>(holds.size() - 1, last + 1);
    return {first, last - first + 1};
  }

  double x_of(Index column) const { return spacing_ * static_cast<double>(column) - half_length_; }
  double y_of(Index row) const { return spacing_ * static_cast<double>(row) - half_width_; }

  /// Returns the height at a position within the rectangle. It is linear in each of the two triangles of a cell. The
  /// diagonal between them goes from the cell's upper left corner to the lower right one.
  double height(double x, double y) const {
    const auto cell = [&](double place, Index count) {
      return std::clamp<Index>(static_cast<Index>(std::floor(place)), 0, count - 2);
    };
    const double across = (x + half_length_) / spacing_;
    const double along = (y + half_width_) / spacing_;
    const Index column = cell(across, heights_.cols());
    const Index row = cell(along, heights_.rows());
    const double u = std::clamp(across - static_cast<double>(column), 0.0, 1.0);
    const double v = std::clamp(along - static_cast<double>(row), 0.0, 1.0);
    const double right = heights_(row, column + 1);
    const double left = heights_(row + 1, column);
    if (u + v <= 1.0) {
      const double corner = heights_(row, column);
      return corner + u * (right - corner) + v * (left - corner);
    }
    const double corner = heights_(row + 1, column + 1);
    return corner + (1.0 - u) * (left - corner) + (1.0 - v) * (right - corner);
  }

  /// Returns the part of the line that is above the rectangle, between the desk and the highest node. Returns nullopt
  /// if there is none.
  std::optional<LineInterval> clipped(const Line& line) const {
    Interval out;
    out.clip(line.origin.x(), line.direction.x(), -half_length_, half_length_);
    out.clip(line.origin.y(), line.direction.y(), -half_width_, half_width_);
    out.clip(line.origin.z(), line.direction.z(), 0.0, highest_);
    return out.empty() ? std::nullopt : std::optional(LineInterval{out.begin, out.end});
  }

  /// Returns the positions within `part` where the line goes from one triangle to the next one, in order. Both ends of
  /// `part` are included.
  std::vector<double> crossings(const Line& line, const LineInterval& part) const {
    std::vector<double> out{part.begin, part.end};
    const auto add = [&](double place, double slope) {
      if (slope == 0.0) return;
      const double from = place + slope * part.begin;
      const double to = place + slope * part.end;
      for (double node = std::ceil(std::min(from, to)); node <= std::max(from, to); ++node) {
        const double at = (node - place) / slope;
        if (at > part.begin && at < part.end) out.push_back(at);
      }
    };
    const double x = (line.origin.x() + half_length_) / spacing_;
    const double y = (line.origin.y() + half_width_) / spacing_;
    const double along_x = line.direction.x() / spacing_;
    const double along_y = line.direction.y() / spacing_;
    add(x, along_x);
    add(y, along_y);
    add(x + y, along_x + along_y);  // crossings with the diagonals
    std::sort(out.begin(), out.end());
    return out;
  }

  /// Calls visit(stretch) for each part of the line that is inside the solid, in order, until `visit` returns false.
  /// The depth of the line below the surface is linear between two crossings.
  template <class Visit>
  void visit(const Line& line, const Visit& visit) const {
    const std::optional<LineInterval> part = clipped(line);
    if (!part) return;
    struct Place {
      double at, depth;
    };
    const auto height_at = [&](double at) {
      const Vector3d point = line.origin + at * line.direction;
      return height(point.x(), point.y());
    };
    const auto look = [&](double at) { return Place{at, height_at(at) - (line.origin.z() + at * line.direction.z())}; };
    std::optional<LineInterval> open;
    std::optional<Place> before;
    for (const double at : crossings(line, *part)) {
      const Place now = look(at);
      if (before) {
        // Both crossings are on the border of the same triangle. If this triangle is on the desk, there is no object,
        // even if rounding errors suggest one.
        const bool has_object = height_at((before->at + now.at) / 2) > 0.0;
        const bool was_in = before->depth >= 0.0;
        const bool is_in = now.depth >= 0.0;
        const double share = was_in == is_in ? 0.0 : before->depth / (before->depth - now.depth);
        const double meets = before->at + share * (now.at - before->at);
        if (has_object && (was_in || is_in)) {
          const double begin = was_in ? before->at : meets;
          const double end = is_in ? now.at : meets;
          if (!open) open = LineInterval{begin, end};
          open->end = end;
        }
        const bool goes_on = has_object && is_in;
        if (open && !goes_on) {
          if (!visit(*open)) return;
          open.reset();
        }
      }
      before = now;
    }
    if (open) visit(*open);
  }

  double spacing_;
  Grid heights_;  ///< metres; each row is along x, and the first row is at the smallest y
  double highest_ = 0.0, half_length_ = 0.0, half_width_ = 0.0;
};

PALPATE_PLUGIN(Shape, HeightMapShape, "height_map", "heights on a grid, from a CSV table, a NumPy array or an image")

}  // namespace palpate::shapes
