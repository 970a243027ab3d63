// SPDX-License-Identifier: MIT
// Gaussian process regression by the book with 100 digits (Boost.Multiprecision over MPFR). It shares nothing with the
// framework but the points it is asked about.
#pragma once

#include "stability/cases.hpp"

#include <boost/multiprecision/mpfr.hpp>

#include <vector>

namespace palpate::stability {

using Real =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

/// Kernel, noise, signal, mean and taps of a case; targets standardised, (value - mean) / signal. An unknown constant
/// in the mean is what it says: a constant added to every covariance.
class Oracle {
 public:
  Oracle(const Case& one, const Points& places, const Eigen::VectorXd& values);

  /// Factorises the covariance with `jitter`, in squares of the signal, on its diagonal. False if it is not positive
  /// definite even with 100 digits.
  bool factorise(double jitter);

  /// Moves every covariance of two different taps by one unit in the last place of a double, each in the direction
  /// that raises the mean at (x, y). Factorise before, and again afterwards.
  void nudge_covariances(double x, double y);

  struct Posterior {
    Real mean;             ///< standardised
    Real variance;         ///< in squares of the signal
    double weights = 0.0;  ///< the norm of A^-1 k_*
  };
  Posterior at(double x, double y) const;

  /// A^-1 targets.
  const std::vector<Real>& alpha() const { return alpha_; }
  const std::vector<Real>& targets() const { return targets_; }
  /// Variance on the diagonal beyond the kernel's, in squares of the signal.
  const Real& diagonal() const { return diagonal_; }
  Real log_marginal_likelihood() const;
  /// The smallest squared pivot: an upper bound of the smallest eigenvalue, within a factor of n most often.
  double least_pivot() const;

 private:
  using Row = std::vector<Real>;
  Row covariances_with(double x, double y) const;
  Real kernel(double ax, double ay, double bx, double by) const;
  void forward(Row& b) const;
  void backward(Row& b) const;

  const Case& case_;
  const Points& places_;
  std::vector<Row> covariance_;  ///< lower triangle, without noise
  std::vector<Row> factor_;
  Row targets_;
  Row alpha_;
  Real diagonal_;
};

}  // namespace palpate::stability
