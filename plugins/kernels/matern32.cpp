// SPDX-License-Identifier: MIT
// Matern kernel with nu = 3/2: k = (1 + s) exp(-s), s = sqrt(3) r (Rasmussen and Williams 2006, equation 4.17).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern32Shape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSlopes = true;

  PALPATE_INLINE double value(double r2) const {
    const double s = std::sqrt(3.0 * r2);
    return (1.0 + s) * simd::decay(s);
  }
  PALPATE_INLINE double slope(double r2, double& k) const {
    const double s = std::sqrt(3.0 * r2);
    const double falling = simd::decay(s);
    k = (1.0 + s) * falling;
    return 3.0 * falling;
  }
  double bend(double r2) const {
    const double s = std::sqrt(3.0 * r2);
    return 3.0 * (1.0 - s) * simd::decay(s);
  }
};

using Matern32 = Stationary<Matern32Shape>;
PALPATE_PLUGIN(Kernel, Matern32, "matern32", "Matern 3/2: surfaces that are differentiable once, but rough")

}  // namespace palpate::kernels
