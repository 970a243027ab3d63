// SPDX-License-Identifier: MIT
// How many outlines hold each place of a lattice.
#pragma once

#include "outline.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

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

  void add(const Outline& outline) {
    const Cuts first = Cuts(outline.first).scaled(x_.first, x_.step, y_.first, y_.step);
    if (outline.kind == Outline::Kind::one) {
      const Cells rows = rows_of(first);
      for (int row = rows.begin; row < rows.end; ++row) mark(row, cells(first, row), 1.0);
      return;
    }
    const Cuts second = Cuts(outline.second).scaled(x_.first, x_.step, y_.first, y_.step);
    const Cells of_first = rows_of(first);
    const Cells of_second = rows_of(second);
    for (int row = of_first.begin; row < of_first.end; ++row) mark(row, cells(first, row), 1.0);
    // What both hold is counted once if they are united, and not at all if one is taken from the other.
    for (int row = std::max(of_first.begin, of_second.begin); row < std::min(of_first.end, of_second.end); ++row) {
      const Cells a = cells(first, row);
      const Cells b = cells(second, row);
      mark(row, {std::max(a.begin, b.begin), std::min(a.end, b.end)}, -1.0);
    }
    if (outline.kind != Outline::Kind::two) return;
    for (int row = of_second.begin; row < of_second.end; ++row) mark(row, cells(second, row), 1.0);
  }

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

  void mark(int row, const Cells& cells, double sign) {
    if (cells.begin >= cells.end) return;
    marks_(cells.begin, row) += sign;
    marks_(cells.end, row) -= sign;
  }

  Axis x_, y_;
  Eigen::MatrixXd marks_;
};

}  // namespace palpate::footprints
