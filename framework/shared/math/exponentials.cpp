// SPDX-License-Identifier: MIT
#include <palpate/math.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "math/exponentials.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::math::HWY_NAMESPACE {
namespace {

/// Computes e^x by x = n ln 2 + r with |r| <= ln 2 / 2. The series of e^r ends at r^13 / 13!, with an error below
/// 5e-18.
HWY_INLINE Vector exponential(Vector x) {
  x = hn::IfThenElse(hn::Lt(x, all(-708.0)), all(-708.0), x);
  const Vector bounded = hn::IfThenElse(hn::Gt(x, all(709.0)), all(709.0), x);  // so that 2^n is finite
  // A sum with this constant has the integer n + 1023 in its last bits. This integer is the biased exponent of 2^n.
  const Vector shift = all(0x1.8p52 + 1023.0);
  const Vector shifted = hn::MulAdd(bounded, all(0x1.71547652b82fep0), shift);  // 1 / ln 2
  const Vector n = hn::Sub(shifted, shift);
  // ln 2 as a sum of two numbers. 0x1.62e42feep-1 has 32 significant bits, so its product with n is exact.
  const Vector r = hn::NegMulAdd(n, all(0x1.a39ef35793c76p-33), hn::NegMulAdd(n, all(0x1.62e42feep-1), x));
  Vector sum = all(1.0 / 6227020800);
  for (const double coefficient : {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
                                   1.0 / 5040, 1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 1.0 / 2})
    sum = hn::MulAdd(sum, r, all(coefficient));
  sum = hn::Add(hn::MulAdd(hn::Mul(sum, r), r, r), all(1.0));
  const hn::RebindToUnsigned<hn::ScalableTag<double>> bits;
  return hn::Mul(sum, hn::BitCast(kReals, hn::ShiftLeft<52>(hn::BitCast(bits, shifted))));
}

void exponentials(const double* x, std::ptrdiff_t count, double* out) {
  std::ptrdiff_t i = 0;
  for (; i + kLanes <= count; i += kLanes) hn::StoreU(exponential(hn::LoadU(kReals, x + i)), kReals, out + i);
  if (i == count) return;
  HWY_ALIGN double rest[kLanes] = {};
  for (std::ptrdiff_t k = i; k < count; ++k) rest[k - i] = x[k];
  put(exponential(at(rest)), rest);
  for (; i < count; ++i) out[i] = rest[i % kLanes];
}

}  // namespace
}  // namespace palpate::math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::math {

void exp(const double* x, std::ptrdiff_t count, double* out) { PALPATE_DISPATCH(exponentials)(x, count, out); }

}  // namespace palpate::math
#endif
