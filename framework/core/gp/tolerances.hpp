// SPDX-License-Identifier: MIT
// How much rounding a factorisation may show before something is done about it. In units of n eps, n the number of
// taps, and relative to the largest prior variance.
#pragma once

#include <limits>

namespace palpate {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A pivot d^2 = diagonal - l.l carries a rounding error of up to about (n + 1) eps diagonal (Higham, Accuracy and
/// Stability of Numerical Algorithms, 2002, section 10.1): one that is not above it has no correct digit.
#ifdef PALPATE_SABOTAGE_NO_PIVOT_GUARD
constexpr double kPivotGuard = -std::numeric_limits<double>::infinity();
#else
constexpr double kPivotGuard = 1.0;
#endif

/// What is added to the diagonal when a pivot fails: the first amount is above what rounding can take away, the last
/// is below what anybody would see, 100 n eps = 4e-13 for 17 taps. A matrix that is not positive definite even then is
/// none that rounding made so.
#ifdef PALPATE_SABOTAGE_LARGE_JITTER
constexpr double kFirstJitter = 1e-4 / kEpsilon;
constexpr double kLastJitter = 1e-4 / kEpsilon;
#else
constexpr double kFirstJitter = 10.0;
constexpr double kLastJitter = 100.0;
#endif

}  // namespace palpate
