// SPDX-License-Identifier: MIT
#include "depths.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "primitives/depths.cpp"
#include "math/highway.hpp"

// Compiled for each set of instructions, as a compiler makes vectors of it. Products are not fused with sums: what is
// computed is the same to the last bit.
HWY_BEFORE_NAMESPACE();
namespace palpate::footprints::HWY_NAMESPACE {
namespace {

constexpr int kRound = Places::kRound;
constexpr int kWord = Places::kWord;

using Bytes = LabelModel::Step __attribute__((vector_size(kRound)));
using Word = LabelModel::Step __attribute__((vector_size(kWord)));

HWY_INLINE void load(const LabelModel::Step* from, Bytes& out) { std::memcpy(&out, from, sizeof(out)); }

/// Of each byte the highest bit: whether it is that of a depth that is not negative.
HWY_INLINE void load_held(const LabelModel::Step* from, Bytes& out) {
  static_assert(LabelModel::kSteps == 128);
  load(from, out);
  out = (out + 63) & 128;
}

HWY_INLINE bool any(const Bytes& bytes) {
  std::uint64_t parts[kRound / 8];
  std::memcpy(parts, &bytes, sizeof(parts));
  return (parts[0] | parts[1] | parts[2] | parts[3]) != 0;
}

// A word of places at a time. By reference, as these vectors are passed otherwise from one set of instructions to
// another.
using Places8 = float __attribute__((vector_size(4 * kWord)));
using Bits8 = std::int32_t __attribute__((vector_size(4 * kWord)));

HWY_INLINE void root(Places8& x) {
  float parts[kWord];
  std::memcpy(parts, &x, sizeof(x));
  for (float& part : parts) part = std::sqrt(part);
  std::memcpy(&x, parts, sizeof(x));
}

HWY_INLINE void magnitude(Places8& x) {
  Bits8 bits;
  std::memcpy(&bits, &x, sizeof(x));
  bits &= 0x7fffffff;
  std::memcpy(&x, &bits, sizeof(x));
}

/// The last byte of each; as one word, where a conversion of vectors would take three times as long.
HWY_INLINE void to_bytes(const Bits8& numbers, LabelModel::Step* out) {
  using Pairs = std::uint64_t __attribute__((vector_size(32)));
  using Half = std::uint64_t __attribute__((vector_size(16)));
  Pairs pairs;
  std::memcpy(&pairs, &numbers, sizeof(pairs));
  pairs = ((pairs | pairs >> 24) & 0xFFFF) << Pairs{0, 16, 32, 48};
  Half first, second;
  std::memcpy(&first, &pairs, sizeof(first));
  std::memcpy(&second, reinterpret_cast<const char*>(&pairs) + sizeof(first), sizeof(second));
  first |= second;
  const std::uint64_t word = first[0] | first[1];
  std::memcpy(out, &word, sizeof(word));
}

/// From the centre, along the axes.
HWY_INLINE void in_axes(const SingleForm& form, const Places8& x, const Places8& y, Places8& u, Places8& v) {
  const Places8 dx = x - form.x;
  const Places8 dy = y - form.y;
  u = form.cosine * dx + form.sine * dy;
  v = form.cosine * dy - form.sine * dx;
}

/// As Form::contains, all bits of those within.
HWY_INLINE void contained_in(const SingleForm& form, const Places8& x, const Places8& y, Bits8& out) {
  Places8 u, v;
  in_axes(form, x, y, u, v);
  if (form.box) {
    magnitude(u);
    magnitude(v);
    out = (u <= form.a) & (v <= form.b);
  } else {
    out = u * u * (form.b * form.b) + v * v * (form.a * form.a) <= form.a * form.a * (form.b * form.b);
  }
}

/// As Form::depth.
HWY_INLINE void depths_in(const SingleForm& form, const Places8& x, const Places8& y, Places8& out) {
  const float a = form.a;
  const float b = form.b;
  Places8 u, v;
  in_axes(form, x, y, u, v);
  if (form.box) {
    magnitude(u);
    magnitude(v);
    const Places8 along = a - u;
    const Places8 across = b - v;
    Places8 beyond = along * along + across * across;
    root(beyond);
    const Places8 least = across < along ? across : along;
    const Places8 most = along < across ? across : along;
    out = most < 0.0F ? -beyond : least;
    return;
  }
  u *= u;
  v *= v;
  Places8 q = u * (b * b) + v * (a * a);
  Places8 slope = u * (b * b * b * b) + v * (a * a * a * a);
  Places8 distance = u + v;
  root(q);
  root(slope);
  root(distance);
  q /= a * b;
  slope /= a * a * b * b;
  const Places8 to_rim = q * (1.0F - q) / slope;
  const Places8 in_circle = a - distance;
  const Places8 centre = Places8{} + b;
  out = in_circle < to_rim ? in_circle : to_rim;
  out = slope > 0.0F ? out : centre;
}

/// A piece, as places are compared with it.
struct SinglePiece {
  SingleForm form, hole;
  bool hollow;
};
HWY_INLINE void take(const Piece& piece, SinglePiece& out) {
  out.form = single(piece.form);
  if (piece.hollow) out.hole = single(piece.hole);
  out.hollow = piece.hollow;
}

/// As Steps::of how deep a word of places lies in a piece.
HWY_INLINE void steps_in(const SinglePiece& piece, bool exact, float per_metre, const float* xs, const float* ys,
                         LabelModel::Step* out) {
  Places8 x, y;
  std::memcpy(&x, xs, sizeof(x));
  std::memcpy(&y, ys, sizeof(y));
  Bits8 steps;
  if (exact) {
    contained_in(piece.form, x, y, steps);
    if (piece.hollow) {
      Bits8 in_hole;
      contained_in(piece.hole, x, y, in_hole);
      steps &= ~in_hole;
    }
    static_assert(LabelModel::kOutside == 0);
    steps &= LabelModel::kInside;
  } else {
    Places8 depth;
    depths_in(piece.form, x, y, depth);
    if (piece.hollow) {
      Places8 of_hole;
      depths_in(piece.hole, x, y, of_hole);
      depth = -of_hole < depth ? -of_hole : depth;
    }
    depth = depth * per_metre + 0.5F * LabelModel::kSteps;
    constexpr float kMost = LabelModel::kSteps;
    const Places8 least = Places8{} - 1.0F;
    const Places8 most = Places8{} + kMost;
    depth = depth > least ? depth : least;
    depth = depth < most ? depth : most;
    steps = __builtin_convertvector(depth + 1.0F, Bits8);
  }
  to_bytes(steps, out);
}

/// The deepest steps of some rows, of a word of them.
HWY_INLINE void deepest_in(const LabelModel::Step* const* rows, int count, int from, Word& out) {
  out = Word{};
  for (int row = 0; row < count; ++row) {
    Word steps;
    std::memcpy(&steps, rows[row] + from, sizeof(steps));
    out = steps > out ? steps : out;
  }
}

void all_steps(const Piece& piece, bool exact, float per_metre, const float* xs, const float* ys, int count,
               LabelModel::Step* out) {
  SinglePiece one;
  take(piece, one);
  for (int from = 0; from < count; from += kWord) steps_in(one, exact, per_metre, xs + from, ys + from, out + from);
}

void all_contained(const Form& form, const float* xs, const float* ys, int count, LabelModel::Step* out) {
  const SingleForm one = single(form);
  for (int from = 0; from < count; from += kWord) {
    Places8 x, y;
    std::memcpy(&x, xs + from, sizeof(x));
    std::memcpy(&y, ys + from, sizeof(y));
    Bits8 contained;
    contained_in(one, x, y, contained);
    to_bytes(contained & 0xFF, out + from);
  }
}

bool weigh_change(Places::Change& change, double most, const float* xs, const float* ys) {
  using Step = LabelModel::Step;
  const LabelModel& labels = *change.labels;
  const LabelModel& labels_before = *change.labels_before;
  const bool exact = !labels.blurs();
  const auto per_metre = static_cast<float>(labels.steps().per_metre);
  SinglePiece changed[Outline::kMost];
  for (int k = 0; k < change.changes; ++k)
    take((*change.outline)[change.changed[static_cast<std::size_t>(k)]], changed[k]);
  const std::uint64_t in_any_case = &labels == &labels_before ? 0 : ~std::uint64_t{0};
  const int pieces = change.outline->size();
  double loss = 0.0;
  double loss_before = 0.0;
  int mistakes = 0;
  std::uint64_t any = 0;
  for (int from = change.until - kWord; from >= change.since; from -= kWord) {
    for (int k = 0; k < change.changes; ++k)
      steps_in(changed[k], exact, per_metre, xs + from, ys + from, change.to[static_cast<std::size_t>(k)] + from);
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

void carry(const Push& push, int count, const float* __restrict xs, const float* __restrict ys, float* __restrict to_x,
           float* __restrict to_y) {
  const Push by = push;
  for (int i = 0; i < count; ++i) {
    const Target now = by.now(Target{xs[i], ys[i]});
    to_x[i] = static_cast<float>(now.x);
    to_y[i] = static_cast<float>(now.y);
  }
}

/// Whether both rows hold any of those that are marked, or one of them does and not the other.
HWY_INLINE bool any_held_by(bool both, const LabelModel::Step* one, const LabelModel::Step* other,
                            const LabelModel::Step* marked, int length) {
  Bytes of_one, of_other, which;
  Bytes out{};
  for (int from = 0; from < length; from += kRound) {
    load_held(one + from, of_one);
    load_held(other + from, of_other);
    load(marked + from, which);
    out |= (both ? of_one & of_other : of_one ^ of_other) & which;
  }
  return any(out);
}

void add_holder(const LabelModel::Step* __restrict row, std::uint16_t bit, int length, std::uint16_t* __restrict out) {
  for (int i = 0; i < length; ++i) out[i] = static_cast<std::uint16_t>(out[i] | (LabelModel::holds(row[i]) ? bit : 0));
}

void deepest_of(const LabelModel::Step* const* rows, int count, int length, LabelModel::Step* out) {
  for (int from = 0; from < length; from += kWord) {
    Word deepest;
    deepest_in(rows, count, from, deepest);
    std::memcpy(out + from, &deepest, sizeof(deepest));
  }
}

bool differ_in_holding(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                       int length) {
  return any_held_by(false, one, other, marked, length);
}

bool hold_the_same(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                   int length) {
  return any_held_by(true, one, other, marked, length);
}

bool holds_any(const LabelModel::Step* row, const LabelModel::Step* marked, int length) {
  Bytes of_row, which;
  Bytes out{};
  for (int from = 0; from < length; from += kRound) {
    load_held(row + from, of_row);
    load(marked + from, which);
    out |= of_row & which;
  }
  return any(out);
}

}  // namespace
}  // namespace palpate::footprints::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::footprints {
namespace {

constexpr float kFar = 1e3F;  // metres

}  // namespace

void Places::add(const Target& place) {
  if (size_ == length()) {
    xs_.resize(xs_.size() + kRound, kFar);
    ys_.resize(ys_.size() + kRound, kFar);
  }
  xs_[static_cast<std::size_t>(size_)] = static_cast<float>(place.x);
  ys_[static_cast<std::size_t>(size_++)] = static_cast<float>(place.y);
}

void Places::seen_after(const Push& push, Places& out) const {
  out.size_ = size_;
  out.xs_ = xs_;
  out.ys_ = ys_;
  PALPATE_DISPATCH(carry)(push, push.before, xs_.data(), ys_.data(), out.xs_.data(), out.ys_.data());
}

void Places::steps(const Piece& piece, const LabelModel& labels, LabelModel::Step* row) const {
  PALPATE_DISPATCH(all_steps)
  (piece, !labels.blurs(), static_cast<float>(labels.steps().per_metre), xs_.data(), ys_.data(), length(), row);
}

void Places::contained(const Form& form, LabelModel::Step* row) const {
  PALPATE_DISPATCH(all_contained)(form, xs_.data(), ys_.data(), (size_ + kWord - 1) / kWord * kWord, row);
}

bool Places::weigh(Change& change, double most) const {
  return PALPATE_DISPATCH(weigh_change)(change, most, xs_.data(), ys_.data());
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

void holders_of(const LabelModel::Step* const* rows, int count, int length, std::uint16_t* out) {
  std::fill_n(out, length, std::uint16_t{0});
  for (int i = 0; i < count; ++i)
    PALPATE_DISPATCH(add_holder)(rows[i], static_cast<std::uint16_t>(1U << i), length, out);
}

void deepest_of(const LabelModel::Step* const* rows, int count, int length, LabelModel::Step* out) {
  PALPATE_DISPATCH(deepest_of)(rows, count, length, out);
}

bool differ_in_holding(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                       int length) {
  return PALPATE_DISPATCH(differ_in_holding)(one, other, marked, length);
}

bool hold_the_same(const LabelModel::Step* one, const LabelModel::Step* other, const LabelModel::Step* marked,
                   int length) {
  return PALPATE_DISPATCH(hold_the_same)(one, other, marked, length);
}

bool holds_any(const LabelModel::Step* row, const LabelModel::Step* marked, int length) {
  return PALPATE_DISPATCH(holds_any)(row, marked, length);
}

}  // namespace palpate::footprints
#endif
