// SPDX-License-Identifier: MIT
// What outlines hold of the places of a lattice.
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

/// Where each row of what a form holds begins and ends.
struct Ends {
  int* begins;
  int* ends;
};
/// Sets in these rows the bits between the ends that lie in a word: of each row the one in its place.
void set_bits(const Cells& rows, const Ends& ends, int word, std::uint64_t* bits);

/// Places in rows, all in equal steps, and what outlines hold of them.
class Lattice {
 public:
  /// None where the places are no lattice, row after row in equal steps up.
  static std::optional<Lattice> over(const PointsView& places) {
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
    return Lattice(x, y);
  }

  /// Of a row of places what lies from one on and before another, where rows have a place more than the lattice.
  struct Run {
    int begin;
    int end;
  };

  /// Calls visit(run) for all that the outline holds, each place once.
  template <class Visit>
  void for_each_run(const Outline& outline, const Visit& visit) {
    if (outline.size() == 1 && !outline[0].hollow) {
      // As most are: what is cut of them is all there is.
      const Cells rows = cut(outline[0].form, 0);
      const Ends ends = ends_of(0);
      for (int row = rows.begin; row < rows.end; ++row) {
        const int first = row * (x_.count + 1);
        if (ends.begins[row] < ends.ends[row]) visit(Run{first + ends.begins[row], first + ends.ends[row]});
      }
      return;
    }
    const Cells rows = hold(outline);
    for (int row = rows.begin; row < rows.end; ++row) {
      const int first = row * (x_.count + 1);
      if (x_.count < 64) {
        for (std::uint64_t held = held_[static_cast<std::size_t>(row)]; held != 0;) {
          const std::uint64_t behind = held + (held & (~held + 1));  // the run's bits are carried into the one behind
          visit(Run{first + __builtin_ctzll(held), first + __builtin_ctzll(behind)});
          held &= behind;
        }
        continue;
      }
      int begin = -1;
      const auto edge = [&](int at) {
        if (begin >= 0) visit(Run{begin, at});
        begin = begin < 0 ? at : -1;
      };
      std::uint64_t before = 0;
      for (int word = 0; word < words_; ++word) {
        const std::uint64_t held = held_[index(row, word)];
        for (std::uint64_t edges = held ^ (held << 1U | before); edges != 0; edges &= edges - 1)
          edge(first + word * 64 + __builtin_ctzll(edges));
        before = held >> 63U;
      }
      if (before != 0) edge(first + words_ * 64);
    }
  }

  /// So many are the places where a run may begin or end.
  int edges() const { return (x_.count + 1) * y_.count; }

  int columns() const { return x_.count; }
  int rows() const { return y_.count; }
  bool operator==(const Lattice& other) const { return x_ == other.x_ && y_ == other.y_; }

 private:
  std::size_t index(int row, int word) const {
    return static_cast<std::size_t>(word) * static_cast<std::size_t>(y_.count) + static_cast<std::size_t>(row);
  }

  Lattice(const Axis& x, const Axis& y)
      : x_(x),
        y_(y),
        begins_(static_cast<std::size_t>(2 * y.count)),
        ends_(begins_.size()),
        words_((x.count + 63) / 64),
        held_(static_cast<std::size_t>(words_ * y.count), 0),
        of_piece_(static_cast<std::size_t>(2 * y.count)) {}

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

  /// The rows that a form may reach into, and, in the place for it, what it holds of them.
  Cells cut(const Form& form, std::size_t at) {
    const Cuts cuts = Cuts(form).scaled(x_.first, x_.step, y_.first, y_.step);
    const Cells rows = y_.within(cuts.y - cuts.reach, cuts.y + cuts.reach);
    const Ends ends = ends_of(at);
    cuts.rows(rows.begin, rows.end, x_.count, ends.begins, ends.ends);
    return rows;
  }
  Ends ends_of(std::size_t at) {
    const std::size_t from = at * static_cast<std::size_t>(y_.count);
    return {begins_.data() + from, ends_.data() + from};
  }

  Axis x_, y_;
  std::vector<int> begins_, ends_;  ///< of the form that is looked at, and of its hole, in each row
  int words_;                       ///< of a row
  std::vector<std::uint64_t>
      held_;  ///< by the outline that is looked at: a bit for each place, word by word of all rows
  std::vector<std::uint64_t> of_piece_;  ///< and of its hole: one word of all rows
};

/// How often each place is held: where a row of what an outline holds begins and ends is marked, and the marks are
/// summed up in the end.
class LatticeCounts {
 public:
  explicit LatticeCounts(Lattice lattice)
      : lattice_(std::move(lattice)), marks_(Eigen::MatrixXd::Zero(lattice_.columns() + 1, lattice_.rows())) {}

  const Lattice& lattice() const { return lattice_; }
  /// The outline counts for so much in each place that it holds.
  void add(const Lattice::Run& run, double weight) {
    marks_.data()[run.begin] += weight;
    marks_.data()[run.end] -= weight;
  }
  void add(const Outline& outline, double weight) {
    lattice_.for_each_run(outline, [&](const Lattice::Run& run) { add(run, weight); });
  }
  void sum(VectorOut out) const {
    Eigen::Index place = 0;
    for (int row = 0; row < lattice_.rows(); ++row) {
      double count = 0.0;
      for (int column = 0; column < lattice_.columns(); ++column) out(place++) = count += marks_(column, row);
    }
  }

 private:
  Lattice lattice_;
  Eigen::MatrixXd marks_;
};

/// What each of many pieces holds of the places of one lattice: found once, asked for again and again.
class LatticeRuns {
 public:
  using Run = Lattice::Run;

  explicit LatticeRuns(Lattice lattice) : lattice_(std::move(lattice)) {}

  void append(const Outline& outline) {
    lattice_.for_each_run(outline, [this](const Run& run) { runs_.push_back(run); });
    first_.push_back(runs_.size());
  }
  const Lattice& lattice() const { return lattice_; }

  /// Calls visit(run) for all that a piece holds, each place once; pieces by their number.
  template <class Visit>
  void for_each(std::size_t piece, const Visit& visit) const {
    for (std::size_t i = first_[piece]; i < first_[piece + 1]; ++i) visit(runs_[i]);
  }

 private:
  Lattice lattice_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_{0};
};

/// Which of many outlines hold each place of a lattice: a bit for each.
class LatticeBits {
 public:
  LatticeBits(Lattice lattice, std::size_t outlines)
      : lattice_(std::move(lattice)),
        words_((outlines + 63) / 64),
        bits_(words_ * static_cast<std::size_t>(lattice_.edges()), 0) {}

  /// The next outline, of as many as there are.
  void append(const Outline& outline) {
    const std::uint64_t bit = std::uint64_t{1} << (size_ % 64);
    std::uint64_t* const at = bits_.data() + size_ / 64;
    lattice_.for_each_run(outline, [&](const Lattice::Run& run) {
      at[words_ * static_cast<std::size_t>(run.begin)] ^= bit;
      at[words_ * static_cast<std::size_t>(run.end)] ^= bit;
    });
    ++size_;
  }
  /// To be called after the last one.
  void fill();

  const Lattice& lattice() const { return lattice_; }
  /// How many outlines hold each place.
  void count(VectorOut out) const;
  /// Which of 64 outlines hold each place: those from 64 * word on.
  template <class Visit>
  void for_each_place(std::size_t word, const Visit& visit) const {
    const std::uint64_t* at = bits_.data() + word;
    Eigen::Index place = 0;
    for (int row = 0; row < lattice_.rows(); ++row, at += words_) {
      for (int column = 0; column < lattice_.columns(); ++column, at += words_) visit(place++, *at);
    }
  }

 private:
  Lattice lattice_;
  std::size_t words_;
  std::size_t size_ = 0;
  std::vector<std::uint64_t>
      bits_;  ///< words x places, of rows that have a place more; where each begins or ends, first
};

}  // namespace palpate::footprints
