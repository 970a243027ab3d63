// SPDX-License-Identifier: MIT
#include "depths.hpp"

#include "clones.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace palpate::footprints {
namespace {

constexpr double kFar = 1e3;  // metres
constexpr int kRound = Places::kRound;

using Bytes = LabelModel::Step __attribute__((vector_size(kRound)));

PALPATE_INLINE void load(const LabelModel::Step* from, Bytes& out) { std::memcpy(&out, from, sizeof(out)); }

/// Of each byte the highest bit: whether it is that of a depth that is not negative.
PALPATE_INLINE void load_held(const LabelModel::Step* from, Bytes& out) {
  static_assert(LabelModel::kSteps == 128);
  load(from, out);
  out = (out + 63) & 128;
}

PALPATE_INLINE bool any(const Bytes& bytes) {
  std::uint64_t parts[kRound / 8];
  std::memcpy(parts, &bytes, sizeof(parts));
  return (parts[0] | parts[1] | parts[2] | parts[3]) != 0;
}

// Written out for each family and way to look, so that the loops are without branches.
PALPATE_INLINE void depths_in(const Form& form, bool exact, const double* __restrict xs, const double* __restrict ys,
                              int count, double* __restrict out) {
  Form box = form;
  Form ellipse = form;
  box.family = Form::Family::box;
  ellipse.family = Form::Family::ellipse;
  if (form.family == Form::Family::box) {
    if (exact) {
      for (int i = 0; i < count; ++i) out[i] = box.contains(xs[i], ys[i]) ? 1.0 : -1.0;
    } else {
      for (int i = 0; i < count; ++i) out[i] = box.depth(xs[i], ys[i]);
    }
  } else if (exact) {
    for (int i = 0; i < count; ++i) out[i] = ellipse.contains(xs[i], ys[i]) ? 1.0 : -1.0;
  } else {
    for (int i = 0; i < count; ++i) out[i] = ellipse.depth(xs[i], ys[i]);
  }
}

/// Of kRound places; all but the first `count`, a multiple of 4, are outside.
PALPATE_CLONES void steps_in(const Piece& piece, bool exact, LabelModel::Steps steps, const double* xs,
                             const double* ys, int count, LabelModel::Step* __restrict out) {
  double depths[kRound];
  for (int i = count; i < kRound; ++i) depths[i] = -kFar;
  depths_in(piece.form, exact, xs, ys, count, depths);
  if (piece.hollow) {
    double of_hole[kRound];
    depths_in(piece.hole, exact, xs, ys, count, of_hole);
    for (int i = 0; i < count; ++i) depths[i] = std::min(depths[i], -of_hole[i]);
  }
  // As Steps::of: four at a time, of which then bytes are made.
  using Four = double __attribute__((vector_size(32)));
  using Whole = std::int32_t __attribute__((vector_size(16)));
  std::int32_t wholes[kRound];
  for (int i = 0; i < kRound; i += 4) {
    Four four;
    std::memcpy(&four, depths + i, sizeof(four));
    four = four * steps.per_metre + 0.5 * LabelModel::kSteps;
    four = four < -1.0 ? Four{-1.0, -1.0, -1.0, -1.0} : four;
    constexpr double kMost = LabelModel::kSteps;
    four = four > kMost ? Four{kMost, kMost, kMost, kMost} : four;
    const Whole whole = __builtin_convertvector(four + 1.0, Whole);
    std::memcpy(wholes + i, &whole, sizeof(whole));
  }
  for (int i = 0; i < kRound; ++i) out[i] = static_cast<LabelModel::Step>(wholes[i]);
}

PALPATE_CLONES void carry(const Push& push, int count, const double* __restrict xs, const double* __restrict ys,
                          double* __restrict to_x, double* __restrict to_y) {
  const Push by = push;
  for (int i = 0; i < count; ++i) {
    const Target now = by.now(Target{xs[i], ys[i]});
    to_x[i] = now.x;
    to_y[i] = now.y;
  }
}

PALPATE_CLONES void add_holder(const LabelModel::Step* __restrict row, std::uint16_t bit, int length,
                               std::uint16_t* __restrict out) {
  for (int i = 0; i < length; ++i) out[i] = static_cast<std::uint16_t>(out[i] | (LabelModel::holds(row[i]) ? bit : 0));
}

}  // namespace

void Places::add(const Target& place) {
  if (size_ == length()) {
    xs_.resize(xs_.size() + kRound, kFar);
    ys_.resize(ys_.size() + kRound, kFar);
  }
  xs_[static_cast<std::size_t>(size_)] = place.x;
  ys_[static_cast<std::size_t>(size_++)] = place.y;
}

void Places::seen_after(const Push& push, Places& out) const {
  out.size_ = size_;
  out.xs_ = xs_;
  out.ys_ = ys_;
  carry(push, push.before, xs_.data(), ys_.data(), out.xs_.data(), out.ys_.data());
}

void Places::steps(const Piece& piece, const LabelModel& labels, int since, int until, LabelModel::Step* row) const {
  constexpr int kVector = 4;  // what is asked for is rounded to
  const int end = (until + kVector - 1) / kVector * kVector;
  const bool all = since == 0 && until == size_;
  std::array<LabelModel::Step, kRound> some;
  for (int from = since / kVector * kVector; from < end; from += kRound) {
    const int count = std::min(kRound, end - from);
    steps_in(piece, !labels.blurs(), labels.steps(), xs_.data() + from, ys_.data() + from, count,
             all ? row + from : some.data());
    if (!all) std::copy_n(some.data(), count, row + from);
  }
}

void Depths::grow_to(int length) {
  if (length <= length_) return;
  std::vector<Step> longer(static_cast<std::size_t>((Outline::kMost + 1) * length), LabelModel::kOutside);
  for (int i = 0; i <= Outline::kMost && length_ > 0; ++i)
    std::copy_n(row(i), length_, longer.begin() + static_cast<std::ptrdiff_t>(i) * length);
  steps_ = std::move(longer);
  length_ = length;
}

std::uint16_t Depths::holders(std::size_t touch, int pieces) const {
  unsigned out = 0;
  for (int i = 0; i < pieces; ++i) out |= LabelModel::holds(row(i)[touch]) ? 1U << i : 0U;
  return static_cast<std::uint16_t>(out);
}

PALPATE_CLONES bool deepest_of(const LabelModel::Step* const* rows, int count, int length,
                               const LabelModel::Step* before, LabelModel::Step* out) {
  Bytes steps;
  Bytes differing{};
  for (int from = 0; from < length; from += kRound) {
    Bytes deepest{};
    for (int row = 0; row < count; ++row) {
      load(rows[row] + from, steps);
      deepest = steps > deepest ? steps : deepest;
    }
    load(before + from, steps);
    differing |= deepest ^ steps;
    std::memcpy(out + from, &deepest, sizeof(deepest));
  }
  return any(differing);
}

PALPATE_CLONES bool differ_in_holding(const LabelModel::Step* one, const LabelModel::Step* other,
                                      const LabelModel::Step* marked, int length) {
  Bytes of_one, of_other, which;
  Bytes out{};
  for (int from = 0; from < length; from += kRound) {
    load_held(one + from, of_one);
    load_held(other + from, of_other);
    load(marked + from, which);
    out |= (of_one ^ of_other) & which;
  }
  return any(out);
}

PALPATE_CLONES bool holds_any(const LabelModel::Step* row, const LabelModel::Step* marked, int length) {
  Bytes of_row, which;
  Bytes out{};
  for (int from = 0; from < length; from += kRound) {
    load_held(row + from, of_row);
    load(marked + from, which);
    out |= of_row & which;
  }
  return any(out);
}

void holders_of(const LabelModel::Step* const* rows, int count, int length, std::uint16_t* out) {
  std::fill_n(out, length, std::uint16_t{0});
  for (int i = 0; i < count; ++i) add_holder(rows[i], static_cast<std::uint16_t>(1U << i), length, out);
}

}  // namespace palpate::footprints
