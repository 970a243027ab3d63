// SPDX-License-Identifier: MIT
// Elementary functions that give the same bytes on every machine. The last digits of a C library's functions differ
// between libraries and processors, and one digit can change the next tap.
//
// Use these functions for all numbers that a tap may depend on: scores, covariances, random draws. Square roots,
// std::fma and rounding to whole numbers are exact by IEEE 754 and need no replacement.
#pragma once

#include <cmath>
#include <cstddef>

namespace palpate::math {

// The errors below are the largest measured errors, in units of the last place (ulp). NaN gives NaN.

/// e^x, 0.9 ulp. 0 below -745.2, infinity above 709.8.
double exp(double x);
/// ln x, 0.8 ulp. -infinity for 0, NaN for x < 0.
double log(double x);
/// ln (1 + x), 1.2 ulp.
double log1p(double x);
/// x^y for x >= 0, 1 ulp. NaN for x < 0.
double pow(double x, double y);
/// Sine and cosine of x in radians, 0.8 ulp for |x| up to 10^6. Above, the error grows in proportion to |x|; NaN for
/// |x| above 10^9.
double sin(double x);
double cos(double x);
/// Angle of the point (x, y) from the x axis in [-pi, pi], with the sign of y, 1.8 ulp. 0 for (0, 0). x has to be
/// finite.
double atan2(double y, double x);
/// Arcsine in [-pi / 2, pi / 2] and arccosine in [0, pi], 2.6 ulp. NaN for x outside of [-1, 1].
double asin(double x);
double acos(double x);
/// 2 / sqrt(pi) times the integral of e^(-t^2) from x to infinity, 8 ulp; 0 above 27.3.
double erfc(double x);

/// log2 x, 1.7 ulp.
inline double log2(double x) { return log(x) * 1.44269504088896340736; }
/// sqrt(x^2 + y^2), 1 ulp, if the squares neither overflow nor underflow.
inline double hypot(double x, double y) { return std::sqrt(x * x + y * y); }

/// Computes out_i = e^(x_i) for `count` numbers, with the vectors of the instruction set in use
/// (palpate/instruction_sets.hpp). The error is at most 1.2 ulp for x up to 709, and 40 ulp above. Results are never
/// below e^-708 = 3.3e-308; infinity for x above 709.8. `out` may be `x`. The bytes are the same on every processor
/// with fused multiplication and addition (x86 from 2013 on, all 64-bit ARM).
void exp(const double* x, std::ptrdiff_t count, double* out);

}  // namespace palpate::math
