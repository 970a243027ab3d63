// SPDX-License-Identifier: MIT
// Matern kernel with nu = 5/2: k = (1 + s + s^2 / 3) exp(-s), s = sqrt(5) r (Rasmussen and Williams 2006, eq. 4.17).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern52Shape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSlopes = true;

  PALPATE_INLINE double value(double r2) const {
    const double s = std::sqrt(5.0 * r2);
    return (1.0 + s + s * s / 3.0) * simd::decay(s);
  }
  PALPATE_INLINE double slope(double r2, double& k) const {
    const double s = std::sqrt(5.0 * r2);
    const double falling = simd::decay(s);
    k = (1.0 + s + s * s / 3.0) * falling;
    return (5.0 / 3.0) * (1.0 + s) * falling;
  }
  double bend(double r2) const {
    const double s = std::sqrt(5.0 * r2);
    return (5.0 / 3.0) * (1.0 + s - s * s) * simd::decay(s);
  }
};

using Matern52 = Stationary<Matern52Shape>;
PALPATE_PLUGIN(Kernel, Matern52, "matern52", "Matern 5/2: smooth surfaces that are differentiable twice")

}  // namespace palpate::kernels
