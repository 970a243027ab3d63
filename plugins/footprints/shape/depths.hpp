// SPDX-License-Identifier: MIT
// How deep the touches lie in the pieces of an outline: what a move changes is one piece or two, and what the others
// are to the touches need not be asked again.
#pragma once

#include "labels.hpp"
#include "outline.hpp"
#include "push.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace palpate::footprints {

/// The places of all touches, as many at a time as vectors hold.
class Places {
 public:
  /// Rows of something about each touch are whole multiples of this long: places that are no touches are far away.
  static constexpr int kRound = 32;

  int size() const { return size_; }
  int length() const { return static_cast<int>(xs_.size()); }
  void add(const Target& place);
  /// `out` becomes these, as seen after a push.
  void seen_after(const Push& push, Places& out) const;

  /// The steps of the places from `since` on, and before `until`, in a row, by how deep they lie in a piece; perhaps of
  /// a few beside them, too.
  void steps(const Piece& piece, const LabelModel& labels, int since, int until, LabelModel::Step* row) const;

 private:
  int size_ = 0;
  std::vector<double> xs_, ys_;
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

/// The deepest steps of some rows. Returns whether they are other than those before.
bool deepest_of(const LabelModel::Step* const* rows, int count, int length, const LabelModel::Step* before,
                LabelModel::Step* out);

/// Who holds the touches, by such rows.
void holders_of(const LabelModel::Step* const* rows, int count, int length, std::uint16_t* out);

/// Whether a row holds any of the touches that are marked by all bits of a byte.
bool holds_any(const LabelModel::Step* row, const LabelModel::Step* marked, int length);
/// Whether it holds others of them than another row.
bool differ_in_holding(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                       int length);

/// Calls visit(touch) for each of which two rows say otherwise, the latest first; false where it has said so and the
/// rest was left out.
template <class Visit>
bool all_differences(const LabelModel::Step* one, const LabelModel::Step* other, int length, const Visit& visit) {
  for (int from = length - 8; from >= 0; from -= 8) {
    std::uint64_t left = 0;
    std::uint64_t of_other = 0;
    std::memcpy(&left, one + from, sizeof(left));
    std::memcpy(&of_other, other + from, sizeof(of_other));
    for (left ^= of_other; left != 0;) {
      const int byte = 7 - __builtin_clzll(left) / 8;
      left &= (std::uint64_t{1} << (8 * byte)) - 1;
      if (!visit(from + byte)) return false;
    }
  }
  return true;
}

}  // namespace palpate::footprints
