// SPDX-License-Identifier: MIT
// What the posterior of a case truly is, by one of two routes that share nothing with the framework.
#pragma once

#include "stability/oracle.hpp"

#include <optional>

namespace palpate::stability {

using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// Standardised: heights in signals from the mean, variances in squares of the signal. A is the covariance of the taps
/// with noise and jitter.
struct Reference {
  LongVector mean;       ///< at the probes
  LongVector variance;   ///< at the probes
  LongVector tap_mean;   ///< at the taps
  double alpha = 0.0;    ///< norm of A^-1 targets
  double weights = 0.0;  ///< largest norm of A^-1 k_* over the probes
  double least = 0.0;    ///< an upper bound of the smallest eigenvalue of A, mostly within a factor of n
};

/// A case, drawn out.
struct Problem {
  explicit Problem(const Case& which);
  const Case& one;
  Points places;
  Eigen::VectorXd values;
  Points probes;
};

/// The extreme eigenvalues of the covariance of the taps, noise included, jitter not.
struct Spectrum {
  double largest = 1.0;
  double smallest = 1.0;
  /// Infinite from 1e14 on, where double precision cannot tell any more.
  double condition() const;
};
Spectrum spectrum(const Problem& problem);

/// Up to so many points the oracle ends in seconds.
constexpr int kOraclePoints = 500;

/// With the 100-digit oracle of the problem; nothing if the model with `jitter` on its diagonal is not positive
/// definite.
std::optional<Reference> by_oracle(const Problem& problem, Oracle& oracle, double jitter);

/// For more points: covariances in long double, an LU factorisation in double, and iterative refinement with residuals
/// in long double until they are at the last digit.
Reference refined(const Problem& problem, double jitter);

}  // namespace palpate::stability
