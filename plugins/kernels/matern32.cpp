// SPDX-License-Identifier: MIT
// Matern kernel with nu = 3/2: k = (1 + s) * exp(-s), s = sqrt(3) * r (Rasmussen and Williams 2006, equation 4.17).
#include "stationary/stationary.hpp"

namespace palpate::kernels {

struct Matern32Shape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSlopes = true;

  static constexpr double kScale = 3.0;
  void values(Numbers z) const {
    const Block s = z.sqrt();
    z = -s;
    take_exponentials(z);
    z *= 1.0 + s;
  }
  void slopes(Numbers z, Numbers slope) const {
    const Block s = z.sqrt();
    slope = -s;
    take_exponentials(slope);
    z = (1.0 + s) * slope;
    slope *= 3.0;
  }
  void bends(Numbers z) const {
    const Block s = z.sqrt();
    z = -s;
    take_exponentials(z);
    z *= 3.0 * (1.0 - s);
  }
};

using Matern32 = StationaryKernel<Matern32Shape>;
PALPATE_PLUGIN(Kernel, Matern32, "matern32", "Matern 3/2: surfaces that are differentiable once, but rough")

}  // namespace palpate::kernels
