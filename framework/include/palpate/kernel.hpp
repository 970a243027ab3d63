// SPDX-License-Identifier: MIT
// Plugin kind `kernel`: how alike the heights at two places are.
#pragma once

#include <palpate/options.hpp>
#include <palpate/types.hpp>

#include <string>
#include <vector>

namespace palpate {

/// A named hyperparameter of a kernel as it stands now. All are positive, so that fits work on their logarithms.
struct KernelParameter {
  std::string name;  ///< the option it came from, dotted where kernels nest: "kernels.0.length_scale"
  double value;      ///< SI, positive
  /// `metre` for a distance over the area; fits scale their expectations by the size of the area.
  Unit unit = Unit::none;
};

/// The shape of a covariance function; signal variance and noise belong to the process, not to the kernel.
///
/// Laws, checked by the contract tests for every kernel found: symmetric, covariance(A, A) positive semi-definite, its
/// diagonal equal to variance(A), |k(a, b)|^2 <= k(a, a) k(b, b), a batch equal to the same points one by one, finite
/// for all finite points. Equal means within 8 ulp: Eigen rounds differently in packets and in what is left behind
/// them. The same call gives the same bytes. Thread use: const methods may run at the same time.
class Kernel {
 public:
  static constexpr const char* kKind = "kernel";

  virtual ~Kernel() = default;

  /// k(a_i, b_j) for all pairs: `a` n x 2, `b` m x 2, `out` n x m. Never throws, allocates nothing in proportion to n.
  virtual void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const = 0;

  /// k(a_i, a_i): `a` n x 2, `out` n. Cheaper than the diagonal of covariance(a, a).
  virtual void variance(const PointsView& a, VectorOut out) const = 0;

  /// Whether k(a, b) = f_0(a_x, b_x) f_1(a_y, b_y); then the method below is implemented too. A posterior over a grid
  /// of G x G candidates needs 2 G values of such a kernel a tap, instead of G^2.
  virtual bool separable() const { return false; }

  /// One of the factors: f_axis(a_i, b_j) for coordinates along x (axis 0) or y (axis 1), `a` n, `b` m, `out` n x m.
  /// Their product equals covariance() within 8 + |log k| ulp. Never throws.
  virtual void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const;

  /// The hyperparameters in the order of the options.
  virtual std::vector<KernelParameter> parameters() const = 0;

  /// Whether a fit may change the hyperparameters; then the two methods below are implemented too. A kernel without
  /// them serves every config with `fitting: fixed`.
  virtual bool differentiable() const { return false; }

  /// Takes new hyperparameters: P values in the order of parameters(), positive and finite.
  virtual void set_parameters(const VectorView& values);

  /// Covariances, and what they change with: `a` n x 2, `b` m x 2, `value` n x m, `slopes` n x Pm with
  /// slopes(i, p m + j) = d k(a_i, b_j) / d log parameter p. `value` equals covariance(a, b) within 8 ulp; the slopes
  /// are finite for all finite points. Never throws.
  virtual void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const;

  /// Whether it is a function f of the distance alone, with two derivatives everywhere: then what it describes has a
  /// slope at every place, and the method below is implemented too. A belief over space needs it where normals are
  /// felt.
  virtual bool has_gradient() const { return false; }

  /// How alike slopes are at two places so far apart: `along` of those along the line between both, -f''(r), `across`
  /// of those at right angles to it, -f'(r) / r. At r = 0 both are -f''(0). `distances` n, not negative, and n each.
  /// Finite for all finite distances. Never throws.
  virtual void gradient_covariance(const VectorView& distances, VectorOut across, VectorOut along) const;
};

// Views go by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::axis_covariance(int, const VectorView&, const VectorView&, MatrixOut) const {}
inline void Kernel::set_parameters(const VectorView&) {}
// Views go by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::derivatives(const PointsView&, const PointsView&, MatrixOut, MatrixOut) const {}
// Views go by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
inline void Kernel::gradient_covariance(const VectorView&, VectorOut, VectorOut) const {}

}  // namespace palpate
