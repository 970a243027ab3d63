// SPDX-License-Identifier: MIT
// Plugin kind `kernel`: covariance function of a Gaussian process (over heights, labels or distances), without signal
// variance.
#pragma once

#include <palpate/options.hpp>
#include <palpate/types.hpp>

#include <string>
#include <vector>

namespace palpate {

/// A named hyperparameter of a kernel with its present value. All are positive, so that fits work on their logarithms.
struct KernelParameter {
  std::string name;  ///< name of its option, with dots if kernels are nested: "kernels.0.length_scale"
  double value;      ///< SI, positive
  /// `metre` for a distance on the desk. For such a parameter, the priors of a fit scale with the size of the area.
  Unit unit = Unit::none;
};

/// Covariance function without signal variance and noise, which belong to the Gaussian process.
///
/// Laws, checked by the contract tests for every kernel found: symmetric, covariance(A, A) positive semi-definite, its
/// diagonal equal to variance(A), |k(a, b)|^2 <= k(a, a) k(b, b), results of a batch equal to results point by point,
/// finite for all finite points. Equal means within 8 ulp, because Eigen rounds differently inside and outside of
/// packets. The same call gives the same bytes. Const methods may run in several threads at the same time.
class Kernel {
 public:
  static constexpr const char* kKind = "kernel";

  virtual ~Kernel() = default;

  /// Computes k(a_i, b_j) for all pairs: `a` n x 2, `b` m x 2, `out` n x m. Never throws. Allocates no memory in
  /// proportion to n.
  virtual void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const = 0;

  /// Computes k(a_i, a_i): `a` n x 2, `out` n. Cheaper than the diagonal of covariance(a, a).
  virtual void variance(const PointsView& a, VectorOut out) const = 0;

  /// Returns whether k(a, b) = f_0(a_x, b_x) f_1(a_y, b_y). Then axis_covariance() is implemented, too. A posterior
  /// over G x G candidates needs 2 G values of such a kernel per tap, instead of G^2.
  virtual bool separable() const { return false; }

  /// Computes a factor f_axis(a_i, b_j) for coordinates along x (axis 0) or y (axis 1): `a` n, `b` m, `out` n x m. The
  /// product of both factors equals covariance() within 8 + |log k| ulp. Never throws.
  virtual void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const;

  /// Returns the hyperparameters in the order of the options.
  virtual std::vector<KernelParameter> parameters() const = 0;

  /// Returns whether a fit may change the hyperparameters. Then set_parameters() and derivatives() are implemented,
  /// too. Other kernels work with `fitting: fixed`.
  virtual bool differentiable() const { return false; }

  /// Sets the hyperparameters: P values in the order of parameters(), positive and finite.
  virtual void set_parameters(const VectorView& values);

  /// Computes covariances and their derivatives: `a` n x 2, `b` m x 2, `value` n x m, `slopes` n x Pm with
  /// slopes(i, p m + j) = d k(a_i, b_j) / d log parameter p. `value` equals covariance(a, b) within 8 ulp. The
  /// derivatives are finite for all finite points. Never throws.
  virtual void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const;

  /// Returns whether the kernel is a function f of the distance alone, with two derivatives everywhere. Then functions
  /// of the GP have gradients, and gradient_covariance() is implemented, too. Beliefs that use surface normals need it.
  virtual bool has_gradient() const { return false; }

  /// Computes covariances between the gradients at two positions with the distance r. `along` is the covariance of the
  /// components parallel to the line between the positions, -f''(r). `across` is the covariance of the components
  /// perpendicular to that line, -f'(r) / r. At r = 0 both are -f''(0). All arguments have n values; `distances` are
  /// not negative. Finite for all finite distances. Never throws.
  virtual void gradient_covariance(const VectorView& distances, VectorOut across, VectorOut along) const;
};

// Views are passed by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::axis_covariance(int, const VectorView&, const VectorView&, MatrixOut) const {}
inline void Kernel::set_parameters(const VectorView&) {}
// Views are passed by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::derivatives(const PointsView&, const PointsView&, MatrixOut, MatrixOut) const {}
// Views are passed by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::gradient_covariance(const VectorView&, VectorOut, VectorOut) const {}

}  // namespace palpate
