// SPDX-License-Identifier: MIT
// How many outlines hold each place of a lattice.
#pragma once

#include "outline.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace palpate::footprints {

/// Whole numbers from `begin` on, before `end`; none where that is not above `begin`.
struct Cells {
  int begin;
  int end;
};

/// Places along one axis, in equal steps.
struct Axis {
  double first;
  double step;
  int count;

  Axis(double from, double to, int places)
      : first(from), step(places > 1 ? (to - from) / (places - 1) : 1.0), count(places) {}

  bool operator==(const Axis& other) const {
    return first == other.first && step == other.step && count == other.count;
  }
  double at(int i) const { return first + i * step; }
  /// Those of them between two ends, in steps from the first.
  Cells within(double low, double high) const { return {not_below(low), std::min(count, above(high))}; }

 private:
  /// The first whole number that is not below `t`, none of them negative, and the first above it. (Without SSE4.1
  /// std::ceil and std::floor are calls.)
  static int not_below(double t) { return t <= 0.0 ? 0 : above(t) - (static_cast<double>(above(t) - 1) == t ? 1 : 0); }
  static int above(double t) { return t < 0.0 ? 0 : static_cast<int>(t) + 1; }
};

/// How many outlines hold each place of a lattice: where a row of them begins and ends is marked, and the marks are
/// summed up in the end.
class LatticeCounts {
 public:
  /// None where the places are no lattice, row after row in equal steps up.
  static std::optional<LatticeCounts> over(const PointsView& places) {
    const auto count = static_cast<int>(places.rows());
    int columns = 1;
    while (columns < count && places(columns, 1) == places(0, 1)) ++columns;
    if (count == 0 || count % columns != 0) return std::nullopt;
    const Axis x(places(0, 0), places(columns - 1, 0), columns);
    const Axis y(places(0, 1), places(count - columns, 1), count / columns);
    // Steps that are all but rounding are those of nearly equal places.
    constexpr double kLeast = 1e-6;  // metres
    if (x.step < kLeast || y.step < kLeast) return std::nullopt;
    for (int i = 0; i < count; ++i) {
      const double off_x = places(i, 0) - x.at(i % columns);
      const double off_y = places(i, 1) - y.at(i / columns);
      if (std::abs(off_x) > kLeast * x.step || std::abs(off_y) > kLeast * y.step) return std::nullopt;
    }
    return LatticeCounts(x, y);
  }

  void add(const Outline& outline, double weight = 1.0) {
    if (outline.size() == 1 && !outline[0].hollow) {
      const Cuts cuts = in_steps(outline[0].form);
      const Cells rows = rows_of(cuts);
      for (int row = rows.begin; row < rows.end; ++row) mark(row, cells(cuts, row), weight);
      return;
    }
    for_each_run(outline, [&](int row, const Cells& cells) { mark(row, cells, weight); });
  }

  /// Calls visit(row, cells) for all that the outline holds, each place once.
  template <class Visit>
  void for_each_run(const Outline& outline, const Visit& visit) {
    parts_.clear();
    Cells rows{y_.count, 0};
    for (const Piece& piece : outline) {
      const Cuts cuts = in_steps(piece.form);
      parts_.push_back({cuts, piece.hollow ? in_steps(piece.hole) : cuts, rows_of(cuts), piece.hollow});
      rows = {std::min(rows.begin, parts_.back().rows.begin), std::max(rows.end, parts_.back().rows.end)};
    }
    for (int row = rows.begin; row < rows.end; ++row) {
      runs_.clear();
      for (const Part& part : parts_) {
        if (row < part.rows.begin || row >= part.rows.end) continue;
        const Cells whole = cells(part.cuts, row);
        const Cells hole = part.hollow ? cells(part.hole, row) : Cells{0, 0};
        if (hole.begin >= hole.end) {
          add_run(whole);
        } else {
          add_run({whole.begin, std::min(whole.end, hole.begin)});
          add_run({std::max(whole.begin, hole.end), whole.end});
        }
      }
      // Few, and mostly in order.
      int reached = 0;
      for (const Cells& run : runs_) {
        if (run.end <= reached) continue;
        visit(row, Cells{std::max(run.begin, reached), run.end});
        reached = run.end;
      }
    }
  }

  int columns() const { return x_.count; }
  bool same_places(const LatticeCounts& other) const { return x_ == other.x_ && y_ == other.y_; }

  void sum(VectorOut out) const {
    for (int row = 0; row < y_.count; ++row) {
      double count = 0.0;
      for (int column = 0; column < x_.count; ++column) out(row * x_.count + column) = count += marks_(column, row);
    }
  }

 private:
  LatticeCounts(const Axis& x, const Axis& y) : x_(x), y_(y), marks_(Eigen::MatrixXd::Zero(x.count + 1, y.count)) {}

  // Cuts in steps of the lattice, from its first place on.
  Cells rows_of(const Cuts& cuts) const { return y_.within(cuts.y() - cuts.reach(), cuts.y() + cuts.reach()); }
  Cells cells(const Cuts& cuts, int row) const {
    const auto [low, high] = cuts.at(row);
    return low > high ? Cells{0, 0} : x_.within(low, high);
  }

  Cuts in_steps(const Form& form) const { return Cuts(form).scaled(x_.first, x_.step, y_.first, y_.step); }

  void add_run(const Cells& run) {
    if (run.begin >= run.end) return;
    auto place = runs_.end();
    while (place != runs_.begin() && (place - 1)->begin > run.begin) --place;
    runs_.insert(place, run);
  }

  void mark(int row, const Cells& cells, double weight) {
    if (cells.begin >= cells.end) return;
    marks_(cells.begin, row) += weight;
    marks_(cells.end, row) -= weight;
  }

  struct Part {
    Cuts cuts, hole;
    Cells rows;
    bool hollow;
  };

  Axis x_, y_;
  Eigen::MatrixXd marks_;
  std::vector<Part> parts_;  ///< of the outline that is looked at, and the runs of a row of it
  std::vector<Cells> runs_;
};

}  // namespace palpate::footprints
