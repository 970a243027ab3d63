// SPDX-License-Identifier: MIT
// Coverage of taps and candidates by primitives, and overlap of primitives. All vectorised loops are in coverage.cpp.
// They use single precision, or doubles without fused operations, so that every instruction set gives the same bytes.
#pragma once

#include "hypothesis.hpp"
#include "tap_model.hpp"

#include <palpate/footprint.hpp>
#include <palpate/types.hpp>

#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// Positions and labels of all taps. Arrays with one entry per tap are padded to length() entries, a multiple of
/// kRound. The padding acts like desk taps outside every primitive.
class Taps {
 public:
  static constexpr int kRound = 16;
  using Step = LabelModel::Step;

  void add(const Touch& touch);
  /// Copies the taps `made`, moved to their positions after the push.
  void set_after_push(const Taps& made, const Push& push);

  int size() const { return size_; }
  int length() const { return static_cast<int>(x_.size()); }
  Target operator[](int tap) const { return {x_[static_cast<std::size_t>(tap)], y_[static_cast<std::size_t>(tap)]}; }
  bool on(int tap) const { return labels_[static_cast<std::size_t>(tap)] != LabelModel::kOutside; }
  /// Returns LabelModel::kInside for each tap with the label of an object, otherwise LabelModel::kOutside.
  const Step* labels() const { return labels_.data(); }
  /// Returns the number of taps with the label of an object.
  int objects() const { return objects_; }

  /// Sets `row` (length() entries) to the depth of each tap in a primitive, as a LabelModel::Step.
  void steps(const Primitive& primitive, const LabelModel& labels, Step* row) const;

 private:
  int size_ = 0;
  int objects_ = 0;
  std::vector<float> x_, y_;  ///< metres
  std::vector<Step> labels_;
};

/// Pointers to the rows of a hypothesis, in the order of its primitives. A row holds the depth of each tap in one
/// primitive, as a LabelModel::Step.
using RowList = ShortList<const LabelModel::Step*>;

/// Storage of the rows of a hypothesis, one row per primitive. Particles store no other data about taps.
class TapRows {
 public:
  using Step = LabelModel::Step;

  int length() const { return length_; }
  /// Lengthens all rows; new entries are kOutside.
  void grow(int length);
  /// Replaces all rows by copies of `rows`. Rows of this object may be among them, but only at their present index or a
  /// lower one.
  void set(const RowList& rows);
  Step* row(int primitive) { return steps_.data() + static_cast<std::ptrdiff_t>(primitive) * length_; }
  const Step* row(int primitive) const { return steps_.data() + static_cast<std::ptrdiff_t>(primitive) * length_; }

 private:
  int length_ = 0;
  std::vector<Step> steps_;
};

/// Sets `out` to the largest entry of all rows for each tap: the depth of the tap in the union of the primitives.
void find_deepest(const RowList& rows, int length, LabelModel::Step* out);
/// holds_object(): Returns whether an object tap is inside the primitive of `row`. share_object(): Returns whether one
/// object tap is inside both primitives. hold_different_objects(): Returns whether some object tap is inside exactly
/// one of both primitives.
bool holds_object(const LabelModel::Step* row, const Taps& taps);
bool share_object(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps);
bool hold_different_objects(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps);

/// Candidates or other positions, M x 2 metres.
class CoverageGrid {
 public:
  explicit CoverageGrid(const PointsView& positions);

  int size() const { return static_cast<int>(positions_.rows()); }
  bool matches(const PointsView& positions) const;

  /// Consecutive positions [begin, end).
  struct Span {
    int begin, end;
  };
  using Spans = std::vector<Span>;
  /// Appends the positions that a primitive covers, in order. The function is fast if the positions are a regular grid,
  /// row by row; otherwise it tests each position.
  void add_spans(const Primitive& primitive, Spans& out) const;
  /// Appends the positions that at least one of the primitives covers.
  void add_spans(const ShortList<Primitive>& primitives, Spans& out) const;

 private:
  /// Equally spaced positions along an axis.
  struct Axis {
    Axis(double from, double to, int places)
        : first(from), step(places > 1 ? (to - from) / (places - 1) : 1.0), count(places) {}
    double at(int i) const { return first + i * step; }
    double first, step;
    int count;
  };
  /// Returns whether the positions are the regular grid that x_ and y_ describe, row by row.
  bool has_equal_steps() const;

  Points positions_;
  Axis x_, y_;
  bool regular_;
};

/// Integers at the positions of a grid, stored as differences between consecutive positions.
class GridSums {
 public:
  explicit GridSums(int size) : steps_(static_cast<std::size_t>(size) + 1, 0) {}

  void add(const CoverageGrid::Spans& spans, std::int64_t value) {
    for (const CoverageGrid::Span& span : spans) {
      steps_[static_cast<std::size_t>(span.begin)] += value;
      steps_[static_cast<std::size_t>(span.end)] -= value;
    }
  }
  /// Returns the value at each position, times `factor`.
  Eigen::VectorXd values(double factor) const;

 private:
  std::vector<std::int64_t> steps_;
};

/// Coordinates of forms as separate arrays, for the vectorised comparison.
struct FormTable {
  static constexpr std::size_t kRound = 16;

  /// Replaces the forms and pads the arrays with points at the origin to a multiple of kRound.
  void set(const std::vector<const Form*>& forms);
  std::vector<float> x, y, a, b, cosine, sine, ellipse;  ///< `ellipse`: 1 for an ellipse, 0 for a box
};
/// Adds 1 to `count` for each form of the table that overlaps a primitive of the hypothesis, by the rule of overlap(),
/// up to rounding. `count` has one entry per form.
void count_overlaps(const Hypothesis& hypothesis, const FormTable& table, float* count);

}  // namespace palpate::footprints
