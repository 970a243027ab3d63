// SPDX-License-Identifier: MIT
#include <palpate/math.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "math/exponentials.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::math::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Reals = hn::ScalableTag<double>;
using Vector = hn::Vec<Reals>;

HWY_INLINE Vector of(double value) { return hn::Set(Reals(), value); }

/// x = n ln 2 + r with |r| <= ln 2 / 2, where what the series leaves out beyond r^13 / 13! is less than 5e-18.
HWY_INLINE Vector exponential(Vector x) {
  x = hn::IfThenElse(hn::Lt(x, of(-708.0)), of(-708.0), x);
  const Vector bounded = hn::IfThenElse(hn::Gt(x, of(709.0)), of(709.0), x);  // 2^n has to be a double
  // A number of this size ends in its integer: n + 1023, the exponent of 2^n.
  const Vector shift = of(0x1.8p52 + 1023.0);
  const Vector shifted = hn::MulAdd(bounded, of(0x1.71547652b82fep0), shift);  // 1 / ln 2
  const Vector n = hn::Sub(shifted, shift);
  // ln 2 in two parts, the first of them short enough for n times it to be exact.
  const Vector r = hn::NegMulAdd(n, of(0x1.a39ef35793c76p-33), hn::NegMulAdd(n, of(0x1.62e42feep-1), x));
  Vector sum = of(1.0 / 6227020800);
  for (const double coefficient : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
                                   1.0 / 5040, 1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 1.0 / 2})
    sum = hn::MulAdd(sum, r, of(coefficient));
  sum = hn::Add(hn::MulAdd(hn::Mul(sum, r), r, r), of(1.0));
  const hn::RebindToUnsigned<Reals> bits;
  return hn::Mul(sum, hn::BitCast(Reals(), hn::ShiftLeft<52>(hn::BitCast(bits, shifted))));
}

void exponentials(const double* x, std::ptrdiff_t count, double* out) {
  constexpr auto lanes = static_cast<std::ptrdiff_t>(hn::MaxLanes(Reals()));
  std::ptrdiff_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(exponential(hn::LoadU(Reals(), x + i)), Reals(), out + i);
  if (i == count) return;
  HWY_ALIGN double rest[lanes] = {};
  for (std::ptrdiff_t k = i; k < count; ++k) rest[k - i] = x[k];
  hn::Store(exponential(hn::Load(Reals(), rest)), Reals(), rest);
  for (; i < count; ++i) out[i] = rest[i % lanes];
}

}  // namespace
}  // namespace palpate::math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::math {

void exp(const double* x, std::ptrdiff_t count, double* out) { PALPATE_DISPATCH(exponentials)(x, count, out); }

}  // namespace palpate::math
#endif
