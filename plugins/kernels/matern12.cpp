// SPDX-License-Identifier: MIT
// Matern kernel with nu = 1/2, the exponential: k = exp(-r) (Rasmussen and Williams 2006, section 4.2).
#include "stationary/stationary.hpp"

namespace palpate::kernels {

struct Matern12Shape : PlainShape {
  using PlainShape::PlainShape;

  static constexpr double kScale = 1.0;
  void values(Numbers z) const {
    z = -z.sqrt();
    take_exponentials(z);
  }
  void slopes(Numbers z, Numbers slope) const {
    // At r = 0, the slope -2 df / d(r^2) is infinite. The derivative by the logarithm of the length scale is
    // slope * r^2, which is 0. The lower bound of the root keeps the slope finite.
    slope = 1.0 / z.sqrt().max(1e-150);
    values(z);
    slope *= z;
  }
};

using Matern12 = StationaryKernel<Matern12Shape>;
PALPATE_PLUGIN(Kernel, Matern12, "matern12", "Matern 1/2: rough surfaces, continuous but nowhere differentiable")

}  // namespace palpate::kernels
