// SPDX-License-Identifier: MIT
// Which taps and candidates a primitive covers, and which other primitives it overlaps. All loops that need wide
// vectors are in coverage.cpp. They compute in single precision or in doubles without fused operations, so that every
// instruction set gives the same bytes.
#pragma once

#include "hypothesis.hpp"
#include "tap_model.hpp"

#include <palpate/footprint.hpp>
#include <palpate/types.hpp>

#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// Positions and labels of all taps. Rows with an entry per tap have length(), a multiple of kRound; entries after the
/// last tap belong to no tap, and are outside of every primitive.
class Taps {
 public:
  static constexpr int kRound = 16;
  using Step = LabelModel::Step;

  void add(const Touch& touch);
  /// Sets these taps to `made` as they are seen after a push.
  void set_after_push(const Taps& made, const Push& push);

  int size() const { return size_; }
  int length() const { return static_cast<int>(x_.size()); }
  Target operator[](int tap) const { return {x_[static_cast<std::size_t>(tap)], y_[static_cast<std::size_t>(tap)]}; }
  bool on(int tap) const { return labels_[static_cast<std::size_t>(tap)] != LabelModel::kOutside; }
  /// LabelModel::kInside for each tap with the label of an object, otherwise LabelModel::kOutside.
  const Step* labels() const { return labels_.data(); }
  /// Number of taps with the label of an object.
  int objects() const { return objects_; }

  /// Sets a row of length() entries to the step of the depth of each tap in a primitive.
  void steps(const Primitive& primitive, const LabelModel& labels, Step* row) const;

 private:
  int size_ = 0;
  int objects_ = 0;
  std::vector<float> x_, y_;  ///< metres
  std::vector<Step> labels_;
};

/// Pointers to rows of steps, in the order of the primitives of a hypothesis.
using RowList = ShortList<const LabelModel::Step*>;

/// A row of steps for each primitive of a hypothesis: all that is kept about taps.
class TapRows {
 public:
  using Step = LabelModel::Step;

  int length() const { return length_; }
  /// Makes all rows longer; the new entries are outside.
  void grow(int length);
  /// Copies rows. Those that are rows of this object keep their order, or replace an earlier one.
  void set(const RowList& rows);
  Step* row(int primitive) { return steps_.data() + static_cast<std::ptrdiff_t>(primitive) * length_; }
  const Step* row(int primitive) const { return steps_.data() + static_cast<std::ptrdiff_t>(primitive) * length_; }

 private:
  int length_ = 0;
  std::vector<Step> steps_;
};

/// Sets `out` to the step of each tap in the union of the rows: the largest one.
void find_deepest(const RowList& rows, int length, LabelModel::Step* out);
/// Return whether a row has an object tap inside, whether two rows have one in common, and whether they have different
/// ones.
bool holds_object(const LabelModel::Step* row, const Taps& taps);
bool share_object(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps);
bool hold_different_objects(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps);

/// The candidates, or any other positions: M x 2 metres.
class Grid {
 public:
  explicit Grid(const PointsView& positions);

  int size() const { return static_cast<int>(positions_.rows()); }
  bool matches(const PointsView& positions) const;

  /// Consecutive positions, from `begin` on and before `end`.
  struct Span {
    int begin, end;
  };
  using Spans = std::vector<Span>;
  /// Appends the positions that a primitive covers, in order, each once. This is quick if the positions are rows in
  /// equal steps, and a test of each position otherwise.
  void add_spans(const Primitive& primitive, Spans& out) const;
  /// Appends the positions that any of the primitives covers.
  void add_spans(const ShortList<Primitive>& primitives, Spans& out) const;

 private:
  /// Positions along an axis, in equal steps.
  struct Axis {
    Axis(double from, double to, int places)
        : first(from), step(places > 1 ? (to - from) / (places - 1) : 1.0), count(places) {}
    double at(int i) const { return first + i * step; }
    double first, step;
    int count;
  };
  /// Whether the positions are those of the two axes, row by row.
  bool has_equal_steps() const;

  Points positions_;
  Axis x_, y_;
  bool regular_;
};

/// Whole numbers at the positions of a grid, kept as differences from one position to the next.
class GridSums {
 public:
  explicit GridSums(int size) : steps_(static_cast<std::size_t>(size) + 1, 0) {}

  void add(const Grid::Spans& spans, std::int64_t value) {
    for (const Grid::Span& span : spans) {
      steps_[static_cast<std::size_t>(span.begin)] += value;
      steps_[static_cast<std::size_t>(span.end)] -= value;
    }
  }
  /// The sum at each position, times a factor.
  Eigen::VectorXd values(double factor) const;

 private:
  std::vector<std::int64_t> steps_;
};

/// Forms as the wide loop compares them, coordinate by coordinate.
struct FormTable {
  static constexpr std::size_t kRound = 16;

  /// Replaces the forms; after the last one come points at the origin, up to a multiple of kRound.
  void set(const std::vector<const Form*>& forms);
  std::vector<float> x, y, a, b, cosine, sine, ellipse;  ///< `ellipse`: 1 for an ellipse, 0 for a box
};
/// Adds 1 to `count` of each form of the table that overlaps a primitive of the hypothesis, by overlap() up to
/// rounding. `count` has as many entries as the table.
void count_overlaps(const Hypothesis& hypothesis, const FormTable& table, float* count);

}  // namespace palpate::footprints
