// SPDX-License-Identifier: MIT
// How many outlines hold each place of a lattice.
#pragma once

#include "outline.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
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

  /// Where a row of what an outline holds begins and ends, among the marks.
  struct Run {
    int begin;
    int end;
  };

  void add(const Outline& outline, double weight = 1.0) {
    for_each_run(outline, [&](int row, const Cells& cells) { mark(run(row, cells), weight); });
  }
  /// The same in two steps, for what is added again and again.
  void append_runs(const Outline& outline, std::vector<Run>& out) {
    for_each_run(outline, [&](int row, const Cells& cells) { out.push_back(run(row, cells)); });
  }
  void add(const Run* begin, const Run* end, double weight) {
    for (const Run* run = begin; run != end; ++run) mark(*run, weight);
  }

  /// Calls visit(row, cells) for all that the outline holds, each place once.
  template <class Visit>
  void for_each_run(const Outline& outline, const Visit& visit) {
    if (outline.size() == 1 && !outline[0].hollow) {
      const Cells rows = cut(outline[0].form, 0);
      for (int row = rows.begin; row < rows.end; ++row) {
        const Cells held = cells(0, row);
        if (held.begin < held.end) visit(row, held);
      }
      return;
    }
    // A bit for each place.
    Cells all{y_.count, 0};
    for (const Piece& piece : outline) {
      const Cells rows = cut(piece.form, 0);
      const Cells rows_of_hole = piece.hollow ? cut(piece.hole, 1) : Cells{0, 0};
      all = {std::min(all.begin, rows.begin), std::max(all.end, rows.end)};
      for (int row = rows.begin; row < rows.end; ++row) {
        const Cells whole = cells(0, row);
        const bool hollow = row >= rows_of_hole.begin && row < rows_of_hole.end;
        const Cells hole = hollow ? cells(1, row) : Cells{0, 0};
        if (hole.begin >= hole.end) {
          hold(row, whole);
        } else {
          hold(row, {whole.begin, std::min(whole.end, hole.begin)});
          hold(row, {std::max(whole.begin, hole.end), whole.end});
        }
      }
    }
    for (int row = all.begin; row < all.end; ++row) {
      int begin = -1;  // of what is held up to here
      for (int word = 0; word < words_; ++word) {
        const std::uint64_t held = std::exchange(held_[index(row, word)], 0);
        for (std::uint64_t edges = held ^ (held << 1U | (begin >= 0 ? 1U : 0U)); edges != 0; edges &= edges - 1) {
          const int at = word * 64 + __builtin_ctzll(edges);
          if (begin >= 0) visit(row, Cells{begin, at});
          begin = begin >= 0 ? -1 : at;
        }
      }
      if (begin >= 0) visit(row, Cells{begin, x_.count});
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
  std::size_t index(int row, int word) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(words_) + static_cast<std::size_t>(word);
  }

  LatticeCounts(const Axis& x, const Axis& y)
      : x_(x),
        y_(y),
        marks_(Eigen::MatrixXd::Zero(x.count + 1, y.count)),
        begins_(static_cast<std::size_t>(2 * y.count)),
        ends_(begins_.size()),
        words_((x.count + 63) / 64),
        held_(static_cast<std::size_t>(words_ * y.count), 0) {}

  Run run(int row, const Cells& cells) const {
    const int first = row * (x_.count + 1);
    return {first + cells.begin, first + cells.end};
  }
  void mark(const Run& run, double weight) {
    marks_.data()[run.begin] += weight;
    marks_.data()[run.end] -= weight;
  }

  void hold(int row, const Cells& cells) {
    if (cells.begin >= cells.end) return;
    const auto below = [](int count) { return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1; };
    for (int word = cells.begin / 64; word <= (cells.end - 1) / 64; ++word) {
      held_[index(row, word)] |= below(cells.end - word * 64) & ~below(std::max(cells.begin - word * 64, 0));
    }
  }

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
  std::vector<int> begins_, ends_;   ///< of the form that is looked at, and of its hole, in each row
  int words_;                        ///< of a row
  std::vector<std::uint64_t> held_;  ///< by the outline that is looked at: a bit for each place
};

}  // namespace palpate::footprints
