// SPDX-License-Identifier: MIT
// Rational quadratic kernel, k = (1 + t)^-alpha, t = r^2 / (2 alpha): a mixture of squared exponentials over all
// length scales (Rasmussen and Williams 2006, equation 4.19).
#include "stationary.hpp"

namespace palpate::kernels {

struct RationalQuadraticOptions : StationaryOptions {
  double alpha = 1.0;

  void list(Fields& fields) override {
    StationaryOptions::list(fields);
    fields.real(alpha,
                Field("alpha", "small mixes many length scales, large comes near to rbf").at_least(1e-4).at_most(1e4));
  }
};

/// t, the same for covariance and slopes also where r^2 overflows: with a small alpha the kernel is not yet 0 there.
template <class Array>
auto bounded_t(const Array& r2, double alpha) {
  return (r2.min(1e300) / (2.0 * alpha)).min(1e300);
}

class RationalQuadraticShape {
 public:
  using Options = RationalQuadraticOptions;
  static constexpr double kFarthest = 1e300;
  static constexpr bool kSeparable = false;
  explicit RationalQuadraticShape(const Options& options) : alpha_(options.alpha) {}

  template <class Array>
  void apply(Array r2) const {
    r2 = (1.0 + bounded_t(r2, alpha_)).pow(-alpha_);
  }
  void slopes(const Chunk& r2, Chunk& k, Chunk& g) const {
    const Chunk base = 1.0 + bounded_t(r2, alpha_);
    k = base.pow(-alpha_);
    g = k / base;
  }

  std::vector<KernelParameter> parameters() const { return {{"alpha", alpha_}}; }
  void set_parameters(const VectorView& values) { alpha_ = values(0); }

  /// d log k / d log alpha = alpha (t / (1 + t) - log(1 + t)).
  void own_slopes(const Chunk& r2, const Chunk& k, MatrixOut out) const {
    const Chunk t = bounded_t(r2, alpha_);
    out.col(0) = alpha_ * k * (t / (1.0 + t) - t.log1p());
  }

 private:
  double alpha_;
};

using RationalQuadratic = Stationary<RationalQuadraticShape>;
PALPATE_PLUGIN(Kernel, RationalQuadratic, "rational_quadratic",
               "rational quadratic: a mixture of smooth surfaces of many length scales")

}  // namespace palpate::kernels
