// SPDX-License-Identifier: MIT
// Rational quadratic kernel, k = (1 + t)^-alpha, t = r^2 / (2 alpha): a mixture of squared exponentials over all
// length scales (Rasmussen and Williams 2006, equation 4.19).
#include "stationary.hpp"

#include <cmath>

namespace palpate::kernels {

struct RationalQuadraticOptions : StationaryOptions {
  double alpha = 1.0;

  void list(Fields& fields) override {
    StationaryOptions::list(fields);
    fields.real(alpha,
                Field("alpha", "shape parameter. Small values mix many length scales, and large values approach rbf")
                    .at_least(1e-4)
                    .at_most(1e4));
  }
};

/// Its powers are taken one by one: with an exponent of up to 1e4, vectors would have to find a logarithm to twice as
/// many digits as a number has.
class RationalQuadraticShape {
 public:
  using Options = RationalQuadraticOptions;
  static constexpr double kFarthest = 1e300;
  static constexpr bool kSeparable = false;
  static constexpr bool kOwn = true;
  static constexpr bool kSlopes = false;
  explicit RationalQuadraticShape(const Options& options) : alpha_(options.alpha) {}

  double value(double r2) const { return std::pow(1.0 + bounded_t(r2), -alpha_); }
  double slope(double r2, double& k) const {
    const double base = 1.0 + bounded_t(r2);
    k = std::pow(base, -alpha_);
    return k / base;
  }

  std::vector<KernelParameter> parameters() const { return {{"alpha", alpha_}}; }
  void set_parameters(const VectorView& values) { alpha_ = values(0); }

  /// d log k / d log alpha = alpha (t / (1 + t) - log(1 + t)).
  double own_slope(double r2, double k) const {
    const double t = bounded_t(r2);
    return alpha_ * k * (t / (1.0 + t) - std::log1p(t));
  }

 private:
  /// t, finite also where the quotient is not: with a small alpha the kernel is not yet 0 there.
  double bounded_t(double r2) const { return simd::min(r2 / (2.0 * alpha_), 1e300); }

  double alpha_;
};

using RationalQuadratic = Stationary<RationalQuadraticShape>;
PALPATE_PLUGIN(Kernel, RationalQuadratic, "rational_quadratic",
               "rational quadratic kernel, for smooth surfaces with a mixture of length scales")

}  // namespace palpate::kernels
