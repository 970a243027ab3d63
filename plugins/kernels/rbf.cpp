// SPDX-License-Identifier: MIT
// The squared-exponential kernel of the paper, k = exp(-r^2 / 2) (Sun and Min 2021, section III).
#include "stationary.hpp"

namespace palpate::kernels {

struct RbfShape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSeparable = true;
  static constexpr bool kSlopes = true;

  PALPATE_INLINE double value(double r2) const { return simd::decay(0.5 * r2); }
  PALPATE_INLINE double slope(double r2, double& k) const { return k = value(r2); }
  double bend(double r2) const { return (1.0 - r2) * value(r2); }
};

using Rbf = Stationary<RbfShape>;
PALPATE_PLUGIN(Kernel, Rbf, "rbf", "squared exponential: very smooth surfaces, as in the paper")

}  // namespace palpate::kernels
