// SPDX-License-Identifier: MIT
// How many outlines hold each place of a lattice.
#pragma once

#include "outline.hpp"

#include <palpate/types.hpp>

#include <algorithm>
#include <array>
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

/// How often each of many bits was set.
class BitCounts {
 public:
  explicit BitCounts(std::size_t words) : words_(words) {}

  /// Sets of bits, each of which counts for 2^digit.
  void add(const std::uint64_t* bits, std::size_t digit = 0);
  /// To be called before read().
  void settle();
  /// The counts of the 64 bits of a word.
  void read(std::size_t word, std::uint64_t* out) const;

 private:
  /// A binary digit of all counts, and what waits to be added to it: two are added at once, as that takes no longer.
  struct Digit {
    std::vector<std::uint64_t> sum, waiting;
    bool waits = false;
  };
  std::size_t words_;
  std::vector<Digit> digits_;
};

/// Where each row of what a form holds begins and ends.
struct Ends {
  int* begins;
  int* ends;
};
/// Sets in these rows the bits between the ends that lie in a word: of each row the one in its place.
void set_bits(const Cells& rows, const Ends& ends, int word, std::uint64_t* bits);

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
    const Eigen::ArrayXd xs =
        Eigen::ArrayXd::NullaryExpr(columns, [&](Eigen::Index i) { return x.at(static_cast<int>(i)); });
    for (int row = 0; row < y.count; ++row) {
      const auto here = places.middleRows(Eigen::Index{row} * columns, columns).array();
      if (!((here.col(0) - xs).abs().maxCoeff() <= kLeast * x.step) ||
          !((here.col(1) - y.at(row)).abs().maxCoeff() <= kLeast * y.step))
        return std::nullopt;
    }
    return LatticeCounts(x, y);
  }

  /// Where a row of what an outline holds begins and ends, among the marks.
  struct Run {
    int begin;
    int end;
  };

  void add(const Outline& outline, double weight) {
    for_each_run(outline, [&](const Run& run) { mark(run, weight); });
  }
  /// The same in two steps, for what is added again and again.
  void append_runs(const Outline& outline, std::vector<Run>& out) {
    for_each_run(outline, [&](const Run& run) { out.push_back(run); });
  }
  void add(const Run* begin, const Run* end, double weight) {
    for (const Run* run = begin; run != end; ++run) mark(*run, weight);
  }

  /// Calls visit(at) where in a row of places what the outline holds begins, and where it has ended: of rows that have
  /// a place more than the lattice.
  template <class Visit>
  void for_each_edge(const Outline& outline, const Visit& visit) {
    if (outline.size() == 1 && !outline[0].hollow) {
      // As most are: what is cut of them is all there is.
      const Cells rows = cut(outline[0].form, 0);
      const Ends ends = ends_of(0);
      for (int row = rows.begin; row < rows.end; ++row) {
        if (ends.begins[row] >= ends.ends[row]) continue;
        visit(row * (x_.count + 1) + ends.begins[row]);
        visit(row * (x_.count + 1) + ends.ends[row]);
      }
      return;
    }
    const Cells rows = hold(outline);
    for (int row = rows.begin; row < rows.end; ++row) {
      const int first = row * (x_.count + 1);
      std::uint64_t before = 0;
      for (int word = 0; word < words_; ++word) {
        const std::uint64_t held = held_[index(row, word)];
        for (std::uint64_t edges = held ^ (held << 1U | before); edges != 0; edges &= edges - 1)
          visit(first + word * 64 + __builtin_ctzll(edges));
        before = held >> 63U;
      }
      if (before != 0) visit(first + words_ * 64);
    }
  }

  /// So many are the places where an edge may be.
  std::size_t edges() const { return static_cast<std::size_t>(marks_.size()); }

  /// One outline more is counted.
  void count(const Outline& outline) {
    hold(outline);
    counts_.add(held_.data());
  }
  /// How many outlines that were counted hold each place.
  void counted(VectorOut out) {
    counts_.settle();
    std::array<std::uint64_t, 64> counts;
    for (int row = 0; row < y_.count; ++row) {
      for (int word = 0; word < words_; ++word) {
        counts_.read(index(row, word), counts.data());
        const int first = word * 64;
        for (int i = 0; i < std::min(64, x_.count - first); ++i)
          out(row * x_.count + first + i) = static_cast<double>(counts[static_cast<std::size_t>(i)]);
      }
    }
  }

  int columns() const { return x_.count; }
  int rows() const { return y_.count; }
  bool same_places(const LatticeCounts& other) const { return x_ == other.x_ && y_ == other.y_; }

  void sum(VectorOut out) const {
    for (int row = 0; row < y_.count; ++row) {
      double count = 0.0;
      for (int column = 0; column < x_.count; ++column) out(row * x_.count + column) = count += marks_(column, row);
    }
  }

 private:
  std::size_t index(int row, int word) const {
    return static_cast<std::size_t>(word) * static_cast<std::size_t>(y_.count) + static_cast<std::size_t>(row);
  }

  LatticeCounts(const Axis& x, const Axis& y)
      : x_(x),
        y_(y),
        marks_(Eigen::MatrixXd::Zero(x.count + 1, y.count)),
        begins_(static_cast<std::size_t>(2 * y.count)),
        ends_(begins_.size()),
        words_((x.count + 63) / 64),
        held_(static_cast<std::size_t>(words_ * y.count), 0),
        of_piece_(static_cast<std::size_t>(2 * y.count)),
        counts_(held_.size()) {}

  void mark(const Run& run, double weight) {
    marks_.data()[run.begin] += weight;
    marks_.data()[run.end] -= weight;
  }

  /// Sets a bit for each place that the outline holds, and says in which rows there may be some.
  Cells hold(const Outline& outline) {
    std::fill(held_.begin(), held_.end(), 0);
    Cells all{y_.count, 0};
    for (const Piece& piece : outline) {
      const Cells rows = cut(piece.form, 0);
      if (rows.begin >= rows.end) continue;
      all = {std::min(all.begin, rows.begin), std::max(all.end, rows.end)};
      const Cells hole = piece.hollow ? cut(piece.hole, 1) : Cells{0, 0};
      for (int word = 0; word < words_; ++word) {
        std::uint64_t* const held = held_.data() + index(0, word);
        if (hole.begin >= hole.end) {
          set_bits(rows, ends_of(0), word, held);
          continue;
        }
        std::uint64_t* const own = of_piece_.data();
        std::uint64_t* const taken = own + y_.count;
        std::fill(own, taken + y_.count, 0);
        set_bits(rows, ends_of(0), word, own);
        set_bits(hole, ends_of(1), word, taken);
        for (int row = rows.begin; row < rows.end; ++row) held[row] |= own[row] & ~taken[row];
      }
    }
    return all;
  }

  /// Calls visit(run) for all that the outline holds, each place once.
  template <class Visit>
  void for_each_run(const Outline& outline, const Visit& visit) {
    int begin = -1;
    for_each_edge(outline, [&](int at) {
      if (begin < 0) {
        begin = at;
      } else {
        visit(Run{std::exchange(begin, -1), at});
      }
    });
  }

  /// The rows that a form may reach into, and, in the place for it, what it holds of them.
  Cells cut(const Form& form, std::size_t at) {
    const Cuts cuts = Cuts(form).scaled(x_.first, x_.step, y_.first, y_.step);
    const Cells rows = y_.within(cuts.y() - cuts.reach(), cuts.y() + cuts.reach());
    const Ends ends = ends_of(at);
    cuts.rows(rows.begin, rows.end, x_.count, ends.begins, ends.ends);
    return rows;
  }
  Ends ends_of(std::size_t at) {
    const std::size_t from = at * static_cast<std::size_t>(y_.count);
    return {begins_.data() + from, ends_.data() + from};
  }

  Axis x_, y_;
  Eigen::MatrixXd marks_;
  std::vector<int> begins_, ends_;  ///< of the form that is looked at, and of its hole, in each row
  int words_;                       ///< of a row
  std::vector<std::uint64_t>
      held_;  ///< by the outline that is looked at: a bit for each place, word by word of all rows
  std::vector<std::uint64_t> of_piece_;  ///< and of its hole: one word of all rows
  BitCounts counts_;
};

}  // namespace palpate::footprints
