// SPDX-License-Identifier: MIT
// Matern kernel with nu = 1/2, the exponential: k = exp(-r) (Rasmussen and Williams 2006, section 4.2).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern12Shape : PlainShape {
  using PlainShape::PlainShape;

  PALPATE_INLINE double value(double r2) const { return simd::decay(std::sqrt(r2)); }
  PALPATE_INLINE double slope(double r2, double& k) const {
    k = value(r2);
    // At r = 0 the slope by the length scale, g r^2, is 0; the bound keeps g finite there.
    return k / simd::max(std::sqrt(r2), 1e-150);
  }
};

using Matern12 = Stationary<Matern12Shape>;
PALPATE_PLUGIN(Kernel, Matern12, "matern12", "Matern 1/2: rough surfaces, continuous but nowhere differentiable")

}  // namespace palpate::kernels
