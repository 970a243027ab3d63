// SPDX-License-Identifier: MIT
#include "depths.hpp"

#include "clones.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate::footprints {
namespace {

constexpr double kFar = 1e3;  // metres
constexpr int kRound = Places::kRound;
constexpr int kWord = Places::kWord;

using Bytes = LabelModel::Step __attribute__((vector_size(kRound)));
using Word = LabelModel::Step __attribute__((vector_size(kWord)));

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

// Four places at a time. By reference, as these vectors are passed otherwise from one set of instructions to another.
using Four = double __attribute__((vector_size(32)));
using FourBits = std::int64_t __attribute__((vector_size(32)));

PALPATE_INLINE void root(Four& x) {
  double parts[4];
  std::memcpy(parts, &x, sizeof(x));
  for (double& part : parts) part = std::sqrt(part);
  std::memcpy(&x, parts, sizeof(x));
}

PALPATE_INLINE void magnitude(Four& x) {
  FourBits bits;
  std::memcpy(&bits, &x, sizeof(x));
  bits &= 0x7fffffffffffffff;
  std::memcpy(&x, &bits, sizeof(x));
}

/// From the centre, along the axes.
PALPATE_INLINE void in_axes(const Form& form, const Four& x, const Four& y, Four& u, Four& v) {
  u = form.cosine * (x - form.x) + form.sine * (y - form.y);
  v = form.cosine * (y - form.y) - form.sine * (x - form.x);
}

/// As Form::contains, all bits of those within.
PALPATE_INLINE void contained_in(const Form& form, const Four& x, const Four& y, FourBits& out) {
  Four u, v;
  in_axes(form, x, y, u, v);
  if (form.family == Form::Family::box) {
    magnitude(u);
    magnitude(v);
    out = (u <= form.a) & (v <= form.b);
  } else {
    out = u * u * (form.b * form.b) + v * v * (form.a * form.a) <= form.a * form.a * (form.b * form.b);
  }
}

/// As Form::depth, to the last bit.
PALPATE_INLINE void depths_in(const Form& form, const Four& x, const Four& y, Four& out) {
  const double a = form.a;
  const double b = form.b;
  Four u, v;
  in_axes(form, x, y, u, v);
  if (form.family == Form::Family::box) {
    magnitude(u);
    magnitude(v);
    const Four along = a - u;
    const Four across = b - v;
    Four beyond = along * along + across * across;
    root(beyond);
    const Four least = across < along ? across : along;
    const Four most = along < across ? across : along;
    out = most < 0.0 ? -beyond : least;
    return;
  }
  u *= u;
  v *= v;
  Four q = u * (b * b) + v * (a * a);
  Four slope = u * (b * b * b * b) + v * (a * a * a * a);
  Four distance = u + v;
  root(q);
  root(slope);
  root(distance);
  q /= a * b;
  slope /= a * a * b * b;
  const Four to_rim = q * (1.0 - q) / slope;
  const Four in_circle = a - distance;
  const Four centre = Four{} + b;
  out = in_circle < to_rim ? in_circle : to_rim;
  out = slope > 0.0 ? out : centre;
}

PALPATE_INLINE void to_bytes(const FourBits& first, const FourBits& second, LabelModel::Step* out) {
  const FourBits parts = (first | second << 32) << FourBits{0, 8, 16, 24};
  const std::int64_t word = parts[0] | parts[1] | parts[2] | parts[3];
  std::memcpy(out, &word, sizeof(word));
}

/// As Steps::of how deep places lie in a piece.
PALPATE_INLINE void steps_in(const Piece& piece, bool exact, LabelModel::Steps steps, const Four& x, const Four& y,
                             FourBits& out) {
  if (exact) {
    contained_in(piece.form, x, y, out);
    if (piece.hollow) {
      FourBits in_hole;
      contained_in(piece.hole, x, y, in_hole);
      out &= ~in_hole;
    }
    static_assert(LabelModel::kOutside == 0);
    out &= LabelModel::kInside;
    return;
  }
  Four depth;
  depths_in(piece.form, x, y, depth);
  if (piece.hollow) {
    Four of_hole;
    depths_in(piece.hole, x, y, of_hole);
    depth = -of_hole < depth ? -of_hole : depth;
  }
  depth = depth * steps.per_metre + 0.5 * LabelModel::kSteps;
  constexpr double kMost = LabelModel::kSteps;
  const Four least = Four{} - 1.0;
  const Four most = Four{} + kMost;
  depth = depth > least ? depth : least;
  depth = depth < most ? depth : most;
  using Whole = std::int32_t __attribute__((vector_size(16)));
  out = __builtin_convertvector(__builtin_convertvector(depth + 1.0, Whole), FourBits);
}

/// Of a word of places.
PALPATE_INLINE void steps_in(const Piece& piece, bool exact, LabelModel::Steps steps, const double* xs,
                             const double* ys, LabelModel::Step* out) {
  static_assert(kWord == 8);
  Four x, y;
  FourBits first, second;
  std::memcpy(&x, xs, sizeof(x));
  std::memcpy(&y, ys, sizeof(y));
  steps_in(piece, exact, steps, x, y, first);
  std::memcpy(&x, xs + 4, sizeof(x));
  std::memcpy(&y, ys + 4, sizeof(y));
  steps_in(piece, exact, steps, x, y, second);
  to_bytes(first, second, out);
}

/// The deepest steps of some rows, of a word of them.
PALPATE_INLINE void deepest_in(const LabelModel::Step* const* rows, int count, int from, Word& out) {
  out = Word{};
  for (int row = 0; row < count; ++row) {
    Word steps;
    std::memcpy(&steps, rows[row] + from, sizeof(steps));
    out = steps > out ? steps : out;
  }
}

PALPATE_CLONES void all_steps(const Piece& piece, bool exact, LabelModel::Steps steps, const double* xs,
                              const double* ys, int count, LabelModel::Step* out) {
  for (int from = 0; from < count; from += kWord) steps_in(piece, exact, steps, xs + from, ys + from, out + from);
}

PALPATE_CLONES void all_contained(const Form& form, const double* xs, const double* ys, int count,
                                  LabelModel::Step* out) {
  for (int from = 0; from < count; from += kWord) {
    Four x, y;
    FourBits first, second;
    std::memcpy(&x, xs + from, sizeof(x));
    std::memcpy(&y, ys + from, sizeof(y));
    contained_in(form, x, y, first);
    std::memcpy(&x, xs + from + 4, sizeof(x));
    std::memcpy(&y, ys + from + 4, sizeof(y));
    contained_in(form, x, y, second);
    to_bytes(first & 0xFF, second & 0xFF, out + from);
  }
}

PALPATE_CLONES bool weigh_change(Places::Change& change, double most, const double* xs, const double* ys) {
  using Step = LabelModel::Step;
  const LabelModel& labels = *change.labels;
  const LabelModel& labels_before = *change.labels_before;
  const bool exact = !labels.blurs();
  const LabelModel::Steps steps = labels.steps();
  const std::uint64_t in_any_case = &labels == &labels_before ? 0 : ~std::uint64_t{0};
  const int pieces = change.outline->size();
  double loss = 0.0;
  double loss_before = 0.0;
  int mistakes = 0;
  std::uint64_t any = 0;
  for (int from = change.until - kWord; from >= change.since; from -= kWord) {
    for (int k = 0; k < change.changes; ++k) {
      const int i = change.changed[static_cast<std::size_t>(k)];
      steps_in((*change.outline)[i], exact, steps, xs + from, ys + from, change.to[static_cast<std::size_t>(k)] + from);
    }
    Word deepest;
    deepest_in(change.rows.data(), pieces, from, deepest);
    std::uint64_t left;
    std::uint64_t before;
    std::memcpy(&left, &deepest, sizeof(left));
    std::memcpy(&before, change.deepest_before + from, sizeof(before));
    std::memcpy(change.deepest + from, &left, sizeof(left));
    left = (left ^ before) | in_any_case;
    any |= left;
    while (left != 0) {
      const auto bit = 63U - static_cast<unsigned>(__builtin_clzll(left));
      left &= ~(std::uint64_t{0xFF} << (bit & ~7U));
      const int touch = from + static_cast<int>(bit / 8);
      const bool on = change.objects[touch] != 0;
      const Step step = change.deepest[touch];
      const Step step_before = change.deepest_before[touch];
      loss += labels.loss(step, on);
      if (loss > most) return false;
      loss_before += labels_before.loss(step_before, on);
      mistakes += (labels.mistake(step, on) ? 1 : 0) - (labels_before.mistake(step_before, on) ? 1 : 0);
    }
  }
  change.loss = loss;
  change.loss_before = loss_before;
  change.mistakes = mistakes;
  change.labelled_otherwise = any != 0;
  return true;
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

void Places::steps(const Piece& piece, const LabelModel& labels, LabelModel::Step* row) const {
  all_steps(piece, !labels.blurs(), labels.steps(), xs_.data(), ys_.data(), length(), row);
}

void Places::contained(const Form& form, LabelModel::Step* row) const {
  all_contained(form, xs_.data(), ys_.data(), (size_ + kWord - 1) / kWord * kWord, row);
}

bool Places::weigh(Change& change, double most) const { return weigh_change(change, most, xs_.data(), ys_.data()); }

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

void deepest_of(const LabelModel::Step* const* rows, int count, int length, LabelModel::Step* out) {
  for (int from = 0; from < length; from += kWord) {
    Word deepest;
    deepest_in(rows, count, from, deepest);
    std::memcpy(out + from, &deepest, sizeof(deepest));
  }
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
