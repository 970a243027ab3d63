// SPDX-License-Identifier: MIT
#include <palpate/math.hpp>

#include <cstdint>
#include <limits>

namespace palpate::math {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kMostAngle = 1e9;
constexpr double kPi = 0x1.921fb54442d18p1;
constexpr double kPiLow = 0x1.1a62633145c07p-53;  // kPi + kPiLow is pi to twice the precision
// ln 2 as a sum of two numbers. The first number has 32 significant bits, so its product with an exponent is exact.
constexpr double kLog2 = 0x1.62e42feep-1;
constexpr double kLog2Low = 0x1.a39ef35793c76p-33;

/// A number as the unevaluated sum of two doubles. |low| is at most half of a unit in the last place of `high`.
struct Pair {
  double high;
  double low;
};

/// Returns the exact sum a + b, for |a| >= |b|.
Pair sum(double a, double b) {
  const double high = a + b;
  return {high, b - (high - a)};
}

/// Returns the exact product a * b, for |a| and |b| below 1e150 (Dekker 1971). Does not use fused multiply-add, which
/// some processors lack.
Pair product(double a, double b) {
  const auto half = [](double x) {
    const double scaled = 134217729.0 * x;  // 2^27 + 1
    return scaled - (scaled - x);
  };
  const double high = a * b;
  const double a_high = half(a);
  const double b_high = half(b);
  const double a_low = a - a_high;
  const double b_low = b - b_high;
  return {high, ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// Returns the sum of coefficients[i] * x^i.
template <std::size_t kCount>
double polynomial(const double (&coefficients)[kCount], double x) {
  double out = 0.0;
  for (std::size_t i = kCount; i-- > 0;) out = out * x + coefficients[i];
  return out;
}

/// Returns e^(x + low), where |low| is small compared with the last place of 1.
double exp_of(double x, double low) {
  if (x > 709.8) return kInfinity;
  if (!(x >= -745.2)) return std::isnan(x) ? x : 0.0;
  const double n = std::nearbyint(x * 1.44269504088896340736);
  const double r = (x - n * kLog2) - (n * kLog2Low - low);
  static constexpr double kOf[] = {1.0 / 2,       1.0 / 6,        1.0 / 24,        1.0 / 120,
                                   1.0 / 720,     1.0 / 5040,     1.0 / 40320,     1.0 / 362880,
                                   1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
  return std::ldexp(1.0 + (r + r * r * polynomial(kOf, r)), static_cast<int>(n));
}

/// x = 2^exponent (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)].
struct FloatParts {
  double exponent;
  double f;
};
FloatParts split(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752440) {
    m *= 2.0;
    --exponent;
  }
  return {static_cast<double>(exponent), m - 1.0};
}

// ln (1 + f) = 2 artanh s = 2 (s + s^3 / 3 + s^5 / 5 + ...) with s = f / (2 + f), at most 0.172.
constexpr double kArtanh[] = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11, 2.0 / 13,
                              2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23, 2.0 / 25};

/// Returns the logarithm of a finite x > 0 to about twice the precision of a double.
Pair log_of(double x) {
  const auto [exponent, f] = split(x);
  const Pair below = sum(2.0, f);
  const double s = f / below.high;
  const Pair back = product(s, below.high);
  const double s_low = ((f - back.high) - back.low - s * below.low) / below.high;
  Pair square = product(s, s);
  square.low += 2.0 * s * s_low;
  // The terms 2 s and 2/3 s^3 are computed as Pairs. The later terms are small, so they are computed as doubles.
  Pair third = product(square.high, kArtanh[0]);
  third.low += square.low * kArtanh[0] + square.high * 0x1.5555555555555p-55;  // low part of 2 / 3
  static constexpr double kRest[] = {2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11, 2.0 / 13, 2.0 / 15,
                                     2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23, 2.0 / 25};
  third.low += square.high * square.high * polynomial(kRest, square.high);
  Pair beyond = product(s, third.high);
  beyond.low += s * third.low + s_low * third.high;
  Pair out = sum(2.0 * s, beyond.high);
  out.low += 2.0 * s_low + beyond.low;
  const Pair all = sum(exponent * kLog2, out.high);
  // For the exponent 0, the first argument of this sum is 0, so it is smaller than the second. The sum is exact in this
  // case, too.
  return sum(all.high, all.low + out.low + exponent * kLog2Low);
}

/// Reduction of an angle: x = n pi / 2 + r with |r| <= pi / 4.
struct ReducedAngle {
  int quarter;  ///< n modulo 4
  Pair r;       ///< NaN if |x| > kMostAngle
};
ReducedAngle reduce(double x) {
  if (!(std::abs(x) <= kMostAngle)) return {0, {kNaN, kNaN}};
  // pi / 2 as a sum of three numbers. The first two numbers have 33 significant bits, so their products with n < 2^20
  // are exact.
  constexpr double kHalf[] = {0x1.921fb544p0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
  const double n = std::nearbyint(x * 0x1.45f306dc9c883p-1);  // 2 / pi
  const double first = x - n * kHalf[0];
  const double second = n * kHalf[1];
  const double high = first - second;
  const double low = (first - high) - second - n * kHalf[2];
  return {static_cast<int>(static_cast<std::int64_t>(n) & 3), sum(high, low)};
}

double sine(const Pair& r) {
  static constexpr double kOf[] = {-1.0 / 6,        1.0 / 120,          -1.0 / 5040,          1.0 / 362880,
                                   -1.0 / 39916800, 1.0 / 6227020800.0, -1.0 / 1307674368000, 1.0 / 355687428096000};
  const double square = r.high * r.high;
  return r.high + (r.low * (1.0 - 0.5 * square) + r.high * square * polynomial(kOf, square));
}

double cosine(const Pair& r) {
  static constexpr double kOf[] = {
      1.0 / 24,          -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
      1.0 / 479001600.0, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
  const double square = r.high * r.high;
  const Pair near = sum(1.0, -0.5 * square);
  return near.high + (near.low + square * square * polynomial(kOf, square) - r.high * r.low);
}

/// Returns the arctangent for 0 <= x <= 1.
Pair arctangent(double x) {
  // Above tan(pi / 8): atan x = pi / 4 + atan((x - 1) / (x + 1)).
  const bool steep = x > 0.41421356237309504880;
  const double t = steep ? (x - 1.0) / (x + 1.0) : x;
  const double square = t * t;
  double series = 0.0;  // -1 / 3 + t^2 / 5 - ...
  for (int k = 22; k >= 1; --k) series = (k % 2 == 0 ? 1.0 : -1.0) / (2 * k + 1) + square * series;
  const double beyond = t * square * series;
  if (!steep) return sum(t, beyond);
  const Pair out = sum(0.25 * kPi, t);
  return {out.high, out.low + beyond + 0.25 * kPiLow};
}

}  // namespace

double exp(double x) { return exp_of(x, 0.0); }

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNaN;
  if (x == kInfinity) return x;
  const auto [exponent, f] = split(x);
  const double s = f / (2.0 + f);
  const double square = s * s;
  const double half = 0.5 * f * f;
  // 2 s = f - s f and s f = half - s half. So the error of the term that is subtracted from f is far below the last
  // place of f.
  return exponent * kLog2 - ((half - (s * (half + square * polynomial(kArtanh, square)) + exponent * kLog2Low)) - f);
}

double log1p(double x) {
  const double above = 1.0 + x;
  // The rounding error of 1 + x is corrected to first order.
  if (above == 1.0) return x;
  return above == 0.0 || std::isinf(above) ? log(above) : log(above) + (x - (above - 1.0)) / above;
}

double pow(double x, double y) {
  if (std::isnan(x) || std::isnan(y) || x < 0.0) return kNaN;
  if (y == 0.0 || x == 1.0) return 1.0;
  if (x == 0.0 || std::isinf(x)) return (x == 0.0) == (y > 0.0) ? 0.0 : kInfinity;
  const Pair logarithm = log_of(x);
  if (!(std::abs(y * logarithm.high) < 800.0)) return y * logarithm.high > 0.0 ? kInfinity : 0.0;
  const Pair exponent = product(y, logarithm.high);
  return exp_of(exponent.high, exponent.low + y * logarithm.low);
}

double sin(double x) {
  const ReducedAngle at = reduce(x);
  const double out = at.quarter % 2 == 0 ? sine(at.r) : cosine(at.r);
  return at.quarter < 2 ? out : -out;
}

double cos(double x) {
  const ReducedAngle at = reduce(x);
  const double out = at.quarter % 2 == 0 ? cosine(at.r) : sine(at.r);
  return at.quarter == 1 || at.quarter == 2 ? -out : out;
}

double atan2(double y, double x) {
  const double across = std::abs(y);
  const double along = std::abs(x);
  if (across == 0.0 && along == 0.0) return 0.0;
  Pair out = across <= along ? arctangent(across / along) : arctangent(along / across);
  const auto from = [&](double whole, double whole_low) {
    const Pair rest = sum(whole, -out.high);
    out = {rest.high, rest.low - out.low + whole_low};
  };
  if (across > along) from(0.5 * kPi, 0.5 * kPiLow);
  if (x < 0.0) from(kPi, kPiLow);
  return std::copysign(out.high + out.low, y);
}

double asin(double x) { return std::abs(x) <= 1.0 ? atan2(x, std::sqrt((1.0 - x) * (1.0 + x))) : kNaN; }

double acos(double x) { return std::abs(x) <= 1.0 ? atan2(std::sqrt((1.0 - x) * (1.0 + x)), x) : kNaN; }

double erfc(double x) {
  if (std::isnan(x)) return x;
  if (x < 0.0) return 2.0 - erfc(-x);
  if (x > 27.3) return 0.0;
  constexpr double kRootPi = 1.77245385090551602730;
  if (x < 0.5) {
    // erf x = 2 / sqrt(pi) sum of (-1)^k x^(2 k + 1) / (k! (2 k + 1))
    double term = x;
    double erf = x;
    for (int k = 1; k < 16; ++k) {
      term *= -x * x / k;
      erf += term / (2 * k + 1);
    }
    return 1.0 - 2.0 / kRootPi * erf;
  }
  // Trapezoidal rule with the step h for the integral of Abramowitz and Stegun 7.4.11, plus the contribution of the
  // pole at x (Matta and Reichel, Mathematics of Computation 25, 1971). The relative error is e^(-pi^2 / h^2) = 7e-18.
  constexpr double kStep = 0.5;
  double sum = 0.5 / (x * x);
  for (int n = 1; n <= 13; ++n) {
    const double t = kStep * n;
    sum += exp(-t * t) / (t * t + x * x);
  }
  const Pair square = product(x, x);
  const double gauss = exp_of(-square.high, -square.low);
  const double pole = x < 6.0 ? 2.0 / (exp(2.0 * kPi * x / kStep) - 1.0) : 0.0;
  return 2.0 * kStep * x / kPi * gauss * sum - pole;
}

}  // namespace palpate::math
