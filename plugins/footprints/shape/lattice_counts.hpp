// SPDX-License-Identifier: MIT
// How many outlines hold each place of a lattice.
#pragma once

#include "outline.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <array>
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
    for_each_run(outline, [&](int row, const Cells& cells) {
      marks_(cells.begin, row) += weight;
      marks_(cells.end, row) -= weight;
    });
  }

  /// Calls visit(row, cells) for all that the outline holds, each place once.
  template <class Visit>
  void for_each_run(const Outline& outline, const Visit& visit) {
    constexpr std::size_t kForms = 2 * Outline::kMost;
    std::array<Cells, kForms> rows;  // of each form and hole
    Cells all{y_.count, 0};
    for (int i = 0; i < outline.size(); ++i) {
      const auto at = static_cast<std::size_t>(2 * i);
      rows[at] = cut(outline[i].form, at);
      rows[at + 1] = outline[i].hollow ? cut(outline[i].hole, at + 1) : Cells{0, 0};
      all = {std::min(all.begin, rows[at].begin), std::max(all.end, rows[at].end)};
    }
    for (int row = all.begin; row < all.end; ++row) {
      std::array<Cells, kForms> runs;  // by their beginnings
      std::size_t count = 0;
      const auto add = [&](const Cells& run) {
        if (run.begin >= run.end) return;
        std::size_t place = count++;
        for (; place > 0 && runs[place - 1].begin > run.begin; --place) runs[place] = runs[place - 1];
        runs[place] = run;
      };
      for (std::size_t at = 0; at < static_cast<std::size_t>(2 * outline.size()); at += 2) {
        if (row < rows[at].begin || row >= rows[at].end) continue;
        const Cells whole = cells(at, row);
        const bool hollow = row >= rows[at + 1].begin && row < rows[at + 1].end;
        const Cells hole = hollow ? cells(at + 1, row) : Cells{0, 0};
        if (hole.begin >= hole.end) {
          add(whole);
        } else {
          add({whole.begin, std::min(whole.end, hole.begin)});
          add({std::max(whole.begin, hole.end), whole.end});
        }
      }
      int reached = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (runs[i].end <= reached) continue;
        visit(row, Cells{std::max(runs[i].begin, reached), runs[i].end});
        reached = runs[i].end;
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
  LatticeCounts(const Axis& x, const Axis& y)
      : x_(x),
        y_(y),
        marks_(Eigen::MatrixXd::Zero(x.count + 1, y.count)),
        begins_(static_cast<std::size_t>(2 * Outline::kMost * y.count)),
        ends_(begins_.size()) {}

  /// The rows that a form may reach into, and, in the place for it, what it holds of them.
  Cells cut(const Form& form, std::size_t at) {
    const Cuts cuts = Cuts(form).scaled(x_.first, x_.step, y_.first, y_.step);
    const Cells rows = y_.within(cuts.y() - cuts.reach(), cuts.y() + cuts.reach());
    const std::size_t from = at * static_cast<std::size_t>(y_.count);
    cuts.rows(rows.begin, rows.end, x_.count, begins_.data() + from, ends_.data() + from);
    return rows;
  }
  Cells cells(std::size_t at, int row) const {
    const std::size_t i = at * static_cast<std::size_t>(y_.count) + static_cast<std::size_t>(row);
    return {begins_[i], ends_[i]};
  }

  Axis x_, y_;
  Eigen::MatrixXd marks_;
  std::vector<int> begins_, ends_;  ///< of the outline that is looked at, for each form and hole, in each row
};

}  // namespace palpate::footprints
