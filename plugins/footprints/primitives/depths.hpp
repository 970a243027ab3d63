// SPDX-License-Identifier: MIT
// How deep the touches lie in the pieces of an outline: what a move changes is one piece or two, and what the others
// are to the touches need not be asked again.
#pragma once

#include "labels.hpp"
#include "outline.hpp"
#include "push.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// The places of all touches, as many at a time as vectors hold: in single precision, a hundred millionth of a metre.
class Places {
 public:
  /// Rows of something about each touch are whole multiples of this long: places that are no touches are far away.
  static constexpr int kRound = 32;
  /// So many steps are a word.
  static constexpr int kWord = 8;

  int size() const { return size_; }
  int length() const { return static_cast<int>(xs_.size()); }
  Target operator[](int i) const { return {xs_[static_cast<std::size_t>(i)], ys_[static_cast<std::size_t>(i)]}; }
  void add(const Target& place);
  /// `out` becomes these, as seen after a push.
  void seen_after(const Push& push, Places& out) const;

  /// The steps of all places in a row, by how deep they lie in a piece.
  void steps(const Piece& piece, const LabelModel& labels, LabelModel::Step* row) const;

  /// Sets all bits of the bytes that belong to places which a form contains, and none of the others.
  void contained(const Form& form, LabelModel::Step* row) const;

  /// What the labels say of some pieces, of which a few are others than before.
  struct Change {
    const Outline* outline;
    std::array<const LabelModel::Step*, Outline::kMost> rows;  ///< of steps, of each piece
    std::array<int, Outline::kMost> changed;                   ///< pieces whose rows are to be made
    int changes = 0;
    std::array<LabelModel::Step*, Outline::kMost> to;  ///< these rows
    int since, until;  ///< the touches of which anything may be otherwise; multiples of kWord
    const LabelModel* labels;
    const LabelModel* labels_before;
    const LabelModel::Step* objects;
    const LabelModel::Step* deepest_before;
    LabelModel::Step* deepest;  ///< to be made, between `since` and `until`

    // What comes of it: of the touches of which the deepest step is another, or of all where the model of labels is.
    bool labelled_otherwise = false;
    double loss = 0.0;
    double loss_before = 0.0;
    int mistakes = 0;  ///< more of them
  };
  /// Looks at the touches from the latest on, until there is more loss than `most`: then it returns false.
  bool weigh(Change& change, double most) const;

 private:
  int size_ = 0;
  std::vector<float> xs_, ys_;
};

/// Touches, as they are seen after a push or without one.
struct Seen {
  const Places& places;
  const LabelModel::Step* objects;  ///< all bits of the bytes of those that are of an object
  int of_objects;                   ///< so many are
};

/// A row of steps for each piece of an outline, and one that has the deepest of each touch.
class Depths {
 public:
  using Step = LabelModel::Step;

  /// Makes room for rows of a greater length.
  void grow_to(int length);
  int length() const { return length_; }

  Step* row(int piece) { return steps_.data() + static_cast<std::ptrdiff_t>(piece) * length_; }
  const Step* row(int piece) const { return steps_.data() + static_cast<std::ptrdiff_t>(piece) * length_; }
  using Rows = std::array<const Step*, Outline::kMost>;
  Rows rows() const {
    Rows out{};
    for (int i = 0; i < Outline::kMost; ++i) out[static_cast<std::size_t>(i)] = row(i);
    return out;
  }
  Step* deepest() { return row(Outline::kMost); }
  const Step* deepest() const { return row(Outline::kMost); }

  /// Which of so many pieces hold a touch: bit i is set where piece i does.
  std::uint16_t holders(std::size_t touch, int pieces) const;

 private:
  int length_ = 0;
  std::vector<Step> steps_;
};

/// The deepest steps of some rows.
void deepest_of(const LabelModel::Step* const* rows, int count, int length, LabelModel::Step* out);

/// Who holds the touches, by such rows.
void holders_of(const LabelModel::Step* const* rows, int count, int length, std::uint16_t* out);

/// Whether a row holds any of the touches that are marked by all bits of a byte.
bool holds_any(const LabelModel::Step* row, const LabelModel::Step* marked, int length);
/// Whether two rows hold the same one of them.
bool hold_the_same(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                   int length);
/// Whether it holds others of them than another row.
bool differ_in_holding(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                       int length);

}  // namespace palpate::footprints
