// SPDX-License-Identifier: MIT
#include "coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "primitives/coverage.cpp"
#include "math/highway.hpp"

#ifndef PALPATE_ROW_CUT
#define PALPATE_ROW_CUT
namespace palpate::footprints {

/// Intersection of a form with the rows of a grid, in units of columns and rows. In each row, the form covers the
/// intersection of one or two intervals. An interval has the middle `x + slope * dy` and the half width `half`; dy is
/// the difference between the row and `y`. For an ellipse the half width is multiplied by sqrt(1 - (dy / reach)^2).
struct RowCut {
  bool box = true;
  double x = 0.0, y = 0.0;  ///< centre
  double reach = 0.0;       ///< extent along y
  double slope[2] = {0.0, 0.0}, half[2] = {0.0, 0.0};
};

/// Copy of a form in single precision.
struct FloatForm {
  explicit FloatForm(const Form& form)
      : box(form.family == Form::Family::box),
        x(static_cast<float>(form.x)),
        y(static_cast<float>(form.y)),
        a(static_cast<float>(form.a)),
        b(static_cast<float>(form.b)),
        cosine(static_cast<float>(form.cosine)),
        sine(static_cast<float>(form.sine)) {}
  bool box;
  float x, y, a, b, cosine, sine;
};

}  // namespace palpate::footprints
#endif

HWY_BEFORE_NAMESPACE();
namespace palpate::footprints::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::ScalableTag<float> kSingles;
constexpr hn::ScalableTag<double> kDoubles;
using Singles = hn::Vec<decltype(kSingles)>;
using Doubles = hn::Vec<decltype(kDoubles)>;

HWY_INLINE Singles all(float value) { return hn::Set(kSingles, value); }
HWY_INLINE Singles square(Singles x) { return hn::Mul(x, x); }

/// See Form::depth().
HWY_INLINE Singles depth(const FloatForm& form, Singles x, Singles y) {
  const float a = form.a;
  const float b = form.b;
  const Singles dx = hn::Sub(x, all(form.x));
  const Singles dy = hn::Sub(y, all(form.y));
  const Singles u = hn::Add(hn::Mul(all(form.cosine), dx), hn::Mul(all(form.sine), dy));
  const Singles v = hn::Sub(hn::Mul(all(form.cosine), dy), hn::Mul(all(form.sine), dx));
  if (form.box) {
    const Singles along = hn::Sub(all(a), hn::Abs(u));
    const Singles across = hn::Sub(all(b), hn::Abs(v));
    const Singles from_corner = hn::Neg(hn::Sqrt(hn::Add(square(along), square(across))));
    const Singles from_side = hn::Min(along, across);
    return hn::IfThenElse(hn::Lt(hn::Max(along, across), hn::Zero(kSingles)), from_corner, from_side);
  }
  const Singles uu = square(u);
  const Singles vv = square(v);
  const Singles q = hn::Mul(hn::Sqrt(hn::Add(hn::Mul(uu, all(b * b)), hn::Mul(vv, all(a * a)))), all(1.0F / (a * b)));
  const Singles slope = hn::Mul(hn::Sqrt(hn::Add(hn::Mul(uu, all(b * b * b * b)), hn::Mul(vv, all(a * a * a * a)))),
                                all(1.0F / (a * a * b * b)));
  const Singles to_rim = hn::Div(hn::Mul(q, hn::Sub(all(1.0F), q)), slope);
  const Singles to_circle = hn::Sub(all(a), hn::Sqrt(hn::Add(uu, vv)));
  return hn::IfThenElse(hn::Gt(slope, hn::Zero(kSingles)), hn::Min(to_rim, to_circle), all(b));
}

/// Computes LabelModel::step() for the depths of `count` positions in a primitive.
void steps(const Primitive& primitive, float per_metre, const float* x, const float* y, int count,
           LabelModel::Step* out) {
  const hn::RebindToSigned<decltype(kSingles)> numbers;
  const hn::Rebind<LabelModel::Step, decltype(kSingles)> bytes;
  constexpr float kSteps = LabelModel::kSteps;
  const FloatForm form(primitive.form);
  const FloatForm hole(primitive.hole);
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(kSingles))) {
    const Singles xs = hn::LoadU(kSingles, x + i);
    const Singles ys = hn::LoadU(kSingles, y + i);
    Singles of = depth(form, xs, ys);
    if (primitive.hollow) of = hn::Min(of, hn::Neg(depth(hole, xs, ys)));
    const Singles scaled = hn::Add(hn::Mul(of, all(per_metre)), all(0.5F * kSteps));
    const Singles step = hn::Add(hn::Min(hn::Max(scaled, all(-1.0F)), all(kSteps)), all(1.0F));
    hn::StoreU(hn::DemoteTo(bytes, hn::ConvertTo(numbers, step)), bytes, out + i);
  }
}

/// Computes the columns that a cut covers in `count` rows, starting at row `first`. `begins` gets the first covered
/// column of each row, `ends` the first column after the cut. The grid has `columns` columns.
void cut_rows(const RowCut& cut, int first, int count, int columns, std::int32_t* begins, std::int32_t* ends) {
  const hn::Rebind<std::int32_t, decltype(kDoubles)> numbers;
  const auto all = [](double value) { return hn::Set(kDoubles, value); };
  const Doubles zero = hn::Zero(kDoubles);
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(kDoubles))) {
    const Doubles dy = hn::Sub(hn::Iota(kDoubles, first + i), all(cut.y));
    const Doubles middle = hn::Add(all(cut.x), hn::Mul(all(cut.slope[0]), dy));
    Doubles low, high, inside;  // `inside` is negative in rows outside the form
    if (cut.box) {
      const Doubles other = hn::Add(all(cut.x), hn::Mul(all(cut.slope[1]), dy));
      low = hn::Max(hn::Sub(middle, all(cut.half[0])), hn::Sub(other, all(cut.half[1])));
      high = hn::Min(hn::Add(middle, all(cut.half[0])), hn::Add(other, all(cut.half[1])));
      inside = hn::Sub(all(cut.reach), hn::Abs(dy));
    } else {
      inside = hn::Sub(all(1.0), hn::Div(hn::Mul(dy, dy), all(cut.reach * cut.reach)));
      const Doubles half = hn::Mul(all(cut.half[0]), hn::Sqrt(hn::Max(inside, zero)));
      low = hn::Sub(middle, half);
      high = hn::Add(middle, half);
    }
    high = hn::IfThenElse(hn::Lt(inside, zero), all(-1.0), high);
    const Doubles begin = hn::Ceil(hn::Min(hn::Max(low, zero), all(columns)));
    const Doubles end = hn::Floor(hn::Min(hn::Max(hn::Add(high, all(1.0)), zero), all(columns)));
    hn::StoreU(hn::DemoteTo(numbers, begin), numbers, begins + i);
    hn::StoreU(hn::DemoteTo(numbers, end), numbers, ends + i);
  }
}

/// See Form::reach().
HWY_INLINE Singles reach(bool box, Singles along, Singles across) {
  return box ? hn::Add(hn::Abs(along), hn::Abs(across)) : hn::Sqrt(hn::Add(square(along), square(across)));
}
HWY_INLINE Singles reach(Singles ellipse, Singles along, Singles across) {
  return hn::IfThenElse(hn::Gt(ellipse, hn::Zero(kSingles)), reach(false, along, across), reach(true, along, across));
}

/// See count_overlaps().
void count_overlaps(const Hypothesis& hypothesis, const FormTable& table, float* count) {
  const Singles zero = hn::Zero(kSingles);
  for (std::size_t i = 0; i < table.x.size(); i += hn::Lanes(kSingles)) {
    const auto of = [i](const std::vector<float>& values) { return hn::LoadU(kSingles, values.data() + i); };
    const Singles x = of(table.x), y = of(table.y), a = of(table.a), b = of(table.b);
    const Singles cosine = of(table.cosine), sine = of(table.sine), ellipse = of(table.ellipse);
    auto any = hn::Lt(zero, zero);
    for (const Primitive& primitive : hypothesis.primitives) {
      const FloatForm one(primitive.form);
      const Singles one_a = all(one.a), one_b = all(one.b), one_c = all(one.cosine), one_s = all(one.sine);
      const Singles dx = hn::Sub(x, all(one.x));
      const Singles dy = hn::Sub(y, all(one.y));
      const Singles u = hn::Add(hn::Mul(one_c, dx), hn::Mul(one_s, dy));
      const Singles v = hn::Sub(hn::Mul(one_c, dy), hn::Mul(one_s, dx));
      const Singles other_u = hn::Add(hn::Mul(cosine, dx), hn::Mul(sine, dy));
      const Singles other_v = hn::Sub(hn::Mul(cosine, dy), hn::Mul(sine, dx));
      const Singles c = hn::Add(hn::Mul(one_c, cosine), hn::Mul(one_s, sine));
      const Singles s = hn::Sub(hn::Mul(one_c, sine), hn::Mul(one_s, cosine));
      // Gap between both forms along each axis, as in overlap(). They overlap if no gap is positive.
      const Singles distance = hn::Add(square(dx), square(dy));
      Singles gap = hn::Sub(hn::Sub(distance, reach(one.box, hn::Mul(one_a, u), hn::Mul(one_b, v))),
                            reach(ellipse, hn::Mul(a, other_u), hn::Mul(b, other_v)));
      gap = hn::Max(gap, hn::Sub(hn::Sub(hn::Abs(u), one_a), reach(ellipse, hn::Mul(a, c), hn::Mul(b, s))));
      gap = hn::Max(gap, hn::Sub(hn::Sub(hn::Abs(v), one_b), reach(ellipse, hn::Mul(a, s), hn::Mul(b, c))));
      gap = hn::Max(gap, hn::Sub(hn::Sub(hn::Abs(other_u), a), reach(one.box, hn::Mul(one_a, c), hn::Mul(one_b, s))));
      gap = hn::Max(gap, hn::Sub(hn::Sub(hn::Abs(other_v), b), reach(one.box, hn::Mul(one_a, s), hn::Mul(one_b, c))));
      const auto close = hn::Le(distance, square(hn::Add(one_b, b)));
      any = hn::Or(any, hn::Or(close, hn::Le(gap, zero)));
    }
    hn::StoreU(hn::Add(hn::LoadU(kSingles, count + i), hn::IfThenElseZero(any, all(1.0F))), kSingles, count + i);
  }
}

}  // namespace
}  // namespace palpate::footprints::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::footprints {
namespace {

constexpr float kFar = 1e3F;  // metres
constexpr int kRowsAtOnce = 64;

RowCut cut_of(const Form& form, double x0, double step_x, double y0, double step_y) {
  RowCut out;
  const double reach = form.reach_y();
  out.box = form.family == Form::Family::box;
  out.x = (form.x - x0) / step_x;
  out.y = (form.y - y0) / step_y;
  out.reach = reach / step_y;
  const auto set = [&](int interval, double slope, double half) {
    out.slope[interval] = slope * step_y / step_x;
    out.half[interval] = half / step_x;
  };
  if (!out.box) {
    set(0, form.cosine * form.sine * (form.a * form.a - form.b * form.b) / (reach * reach), form.a * form.b / reach);
    return out;
  }
  // Sides parallel to x limit only the range of rows, not the columns within a row.
  const auto sides = [&](int interval, double along, double across, double side) {
    const bool along_x = std::abs(along) < 1e-12;
    set(interval, along_x ? 0.0 : -across / along,
        along_x ? std::numeric_limits<double>::infinity() : side / std::abs(along));
  };
  sides(0, form.cosine, form.sine, form.a);
  sides(1, -form.sine, form.cosine, form.b);
  return out;
}

/// Returns whether `test(i)`, 0 or 1, is 1 for any object tap.
template <class TapPredicate>
bool any_object(const Taps& taps, const TapPredicate& test) {
  static_assert(LabelModel::kInside % 2 == 1);
  const LabelModel::Step* const labels = taps.labels();
  std::uint8_t any = 0;
  for (int i = 0; i < taps.length(); ++i) any = static_cast<std::uint8_t>(any | (labels[i] & test(i)));
  return any != 0;
}

}  // namespace

void Taps::add(const Touch& touch) {
  if (size_ == length()) {
    x_.resize(x_.size() + kRound, kFar);
    y_.resize(y_.size() + kRound, kFar);
    labels_.resize(labels_.size() + kRound, LabelModel::kOutside);
  }
  const auto at = static_cast<std::size_t>(size_++);
  x_[at] = static_cast<float>(touch.place.x);
  y_[at] = static_cast<float>(touch.place.y);
  labels_[at] = touch.on ? LabelModel::kInside : LabelModel::kOutside;
  objects_ += touch.on ? 1 : 0;
}

void Taps::set_after_push(const Taps& made, const Push& push) {
  *this = made;
  for (int i = 0; i < push.before; ++i) {
    const Target now = push.to_current(made[i]);
    x_[static_cast<std::size_t>(i)] = static_cast<float>(now.x);
    y_[static_cast<std::size_t>(i)] = static_cast<float>(now.y);
  }
}

void Taps::steps(const Primitive& primitive, const LabelModel& labels, Step* row) const {
  PALPATE_DISPATCH(steps)
  (primitive, static_cast<float>(labels.steps_per_metre()), x_.data(), y_.data(), length(), row);
}

void TapRows::grow(int length) {
  if (length <= length_) return;
  std::vector<Step> longer(static_cast<std::size_t>(RowList::kMost * length), LabelModel::kOutside);
  for (int i = 0; i < RowList::kMost && length_ > 0; ++i)
    std::copy_n(row(i), length_, longer.begin() + static_cast<std::ptrdiff_t>(i) * length);
  steps_ = std::move(longer);
  length_ = length;
}

void TapRows::set(const RowList& rows) {
  for (int i = 0; i < rows.size(); ++i) {
    if (rows[i] != row(i)) std::copy_n(rows[i], length_, row(i));
  }
}

void find_deepest(const RowList& rows, int length, LabelModel::Step* out) {
  std::fill_n(out, length, LabelModel::kOutside);
  for (const LabelModel::Step* row : rows) {
    for (int i = 0; i < length; ++i) out[i] = std::max(out[i], row[i]);
  }
}

bool holds_object(const LabelModel::Step* row, const Taps& taps) {
  return any_object(taps, [=](int i) { return LabelModel::inside(row[i]); });
}

bool share_object(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps) {
  return any_object(taps, [=](int i) { return LabelModel::inside(std::min(one[i], other[i])); });
}

bool hold_different_objects(const LabelModel::Step* one, const LabelModel::Step* other, const Taps& taps) {
  return any_object(taps, [=](int i) { return LabelModel::inside(one[i]) != LabelModel::inside(other[i]); });
}

CoverageGrid::CoverageGrid(const PointsView& positions) : positions_(positions), x_(0.0, 0.0, 1), y_(0.0, 0.0, 1) {
  int columns = 1;
  while (columns < size() && positions_(columns, 1) == positions_(0, 1)) ++columns;
  regular_ = size() > 0 && size() % columns == 0;
  if (!regular_) return;
  x_ = Axis(positions_(0, 0), positions_(columns - 1, 0), columns);
  y_ = Axis(positions_(0, 1), positions_(size() - columns, 1), size() / columns);
  regular_ = has_equal_steps();
}

bool CoverageGrid::has_equal_steps() const {
  constexpr double kLeast = 1e-6;  // metres: smaller steps may be rounding errors
  if (x_.step < kLeast || y_.step < kLeast) return false;
  for (int i = 0; i < size(); ++i) {
    if (!(std::abs(positions_(i, 0) - x_.at(i % x_.count)) <= kLeast * x_.step)) return false;
    if (!(std::abs(positions_(i, 1) - y_.at(i / x_.count)) <= kLeast * y_.step)) return false;
  }
  return true;
}

bool CoverageGrid::matches(const PointsView& positions) const {
  return positions.rows() == positions_.rows() && positions == positions_;
}

void CoverageGrid::add_spans(const Primitive& primitive, Spans& out) const {
  if (!regular_) {
    for (int i = 0; i < size(); ++i) {
      if (primitive.contains(positions_(i, 0), positions_(i, 1))) out.push_back({i, i + 1});
    }
    return;
  }
  const auto& cut_rows = PALPATE_DISPATCH(cut_rows);
  const auto cut = [this](const Form& form) { return cut_of(form, x_.first, x_.step, y_.first, y_.step); };
  const RowCut form = cut(primitive.form);
  const RowCut hole = primitive.hollow ? cut(primitive.hole) : RowCut();
  const auto row_at = [this](double y) { return static_cast<int>(std::min(std::max(y, 0.0), 1.0 * y_.count)); };
  const int begin = row_at(form.y - form.reach);
  const int last = row_at(form.y + form.reach + 1.0);
  // Space for all spans. An empty span is overwritten by the next one.
  std::size_t count = out.size();
  out.resize(count + static_cast<std::size_t>(primitive.hollow ? 2 * (last - begin) : last - begin));
  const auto add = [&](int from, int to) {
    out[count] = {from, to};
    count += from < to ? 1 : 0;
  };
  static_assert(kRowsAtOnce % 16 == 0, "the loop writes whole vectors");
  std::array<std::int32_t, kRowsAtOnce> begins, ends, hole_begins, hole_ends;
  for (int row = begin; row < last; row += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, last - row);
    cut_rows(form, row, rows, x_.count, begins.data(), ends.data());
    if (primitive.hollow) cut_rows(hole, row, rows, x_.count, hole_begins.data(), hole_ends.data());
    for (int i = 0; i < rows; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const int from = (row + i) * x_.count;
      if (!primitive.hollow || hole_begins[k] >= hole_ends[k]) {
        add(from + begins[k], from + ends[k]);
      } else {
        add(from + begins[k], from + std::min(ends[k], hole_begins[k]));
        add(from + std::max(begins[k], hole_ends[k]), from + ends[k]);
      }
    }
  }
  out.resize(count);
}

void CoverageGrid::add_spans(const ShortList<Primitive>& primitives, Spans& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  const auto earlier = [](const Span& one, const Span& other) { return one.begin < other.begin; };
  for (const Primitive& primitive : primitives) {
    const auto middle = static_cast<std::ptrdiff_t>(out.size());
    add_spans(primitive, out);
    std::inplace_merge(out.begin() + first, out.begin() + middle, out.end(), earlier);
  }
  if (primitives.size() < 2 || out.begin() + first == out.end()) return;
  auto last = out.begin() + first;
  for (auto span = last + 1; span != out.end(); ++span) {
    if (span->begin <= last->end) {
      last->end = std::max(last->end, span->end);
    } else {
      *++last = *span;
    }
  }
  out.erase(last + 1, out.end());
}

void FormTable::set(const std::vector<const Form*>& forms) {
  const std::size_t size = (forms.size() + kRound - 1) / kRound * kRound;
  for (auto* values : {&x, &y, &a, &b, &cosine, &sine, &ellipse}) values->assign(size, 0.0F);
  for (std::size_t i = 0; i < forms.size(); ++i) {
    const FloatForm one(*forms[i]);
    x[i] = one.x;
    y[i] = one.y;
    a[i] = one.a;
    b[i] = one.b;
    cosine[i] = one.cosine;
    sine[i] = one.sine;
    ellipse[i] = one.box ? 0.0F : 1.0F;
  }
}

void count_overlaps(const Hypothesis& hypothesis, const FormTable& table, float* count) {
  PALPATE_DISPATCH(count_overlaps)(hypothesis, table, count);
}

Eigen::VectorXd GridSums::values(double factor) const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(steps_.size()) - 1);
  std::int64_t sum = 0;
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    sum += steps_[static_cast<std::size_t>(i)];
    out(i) = factor * static_cast<double>(sum);
  }
  return out;
}

}  // namespace palpate::footprints
#endif
