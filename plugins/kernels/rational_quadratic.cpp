// SPDX-License-Identifier: MIT
// Rational quadratic kernel, k = (1 + t)^-alpha, t = r^2 / (2 * alpha): a mixture of squared exponentials over all
// length scales (Rasmussen and Williams 2006, equation 4.19).
#include "stationary/stationary.hpp"

namespace palpate::kernels {

struct RationalQuadraticOptions : StationaryOptions {
  double alpha = 1.0;

  void list(Fields& fields) override {
    StationaryOptions::list(fields);
    fields.real(alpha,
                Field("alpha", "shape parameter. Small values mix many length scales, and large values approach rbf")
                    .within(1e-4, 1e4));
  }
};

class RationalQuadraticShape {
 public:
  using Options = RationalQuadraticOptions;
  static constexpr double kScale = 1.0;
  static constexpr double kFarthest = 1e300;
  static constexpr bool kSeparable = false;
  static constexpr bool kOwn = true;
  static constexpr bool kSlopes = false;
  explicit RationalQuadraticShape(const Options& options) : alpha_(options.alpha) {}

  void values(Numbers z) const {
    for (double& one : z) one = math::pow(1.0 + bounded_t(one), -alpha_);
  }
  void slopes(Numbers z, Numbers slope) const {
    for (Eigen::Index i = 0; i < z.size(); ++i) slope(i) = 1.0 / (1.0 + bounded_t(z(i)));
    values(z);
    slope *= z;
  }

  std::vector<KernelParameter> parameters() const { return {{"alpha", alpha_}}; }
  void set_parameters(const VectorView& values) { alpha_ = values(0); }

  /// d log k / d log alpha = alpha * (t / (1 + t) - log(1 + t)).
  void own_slopes(const Block& z, Numbers k, Numbers slope) const {
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const double t = bounded_t(z(i));
      slope(i) = alpha_ * k(i) * (t / (1.0 + t) - math::log1p(t));
    }
  }

 private:
  /// Returns t with an upper bound. With a small alpha, the quotient can overflow at distances at which the kernel is
  /// not yet 0.
  double bounded_t(double r2) const { return std::min(r2 / (2.0 * alpha_), 1e300); }

  double alpha_;
};

using RationalQuadratic = StationaryKernel<RationalQuadraticShape>;
PALPATE_PLUGIN(Kernel, RationalQuadratic, "rational_quadratic",
               "rational quadratic kernel, for smooth surfaces with a mixture of length scales")

}  // namespace palpate::kernels
