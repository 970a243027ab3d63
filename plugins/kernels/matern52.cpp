// SPDX-License-Identifier: MIT
// Matern kernel with nu = 5/2: k = (1 + s + s^2 / 3) * exp(-s), s = sqrt(5) * r (Rasmussen and Williams 2006, eq.
// 4.17).
#include "stationary/stationary.hpp"

namespace palpate::kernels {

struct Matern52Shape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSlopes = true;

  static constexpr double kScale = 5.0;
  void values(Numbers z) const {
    const Block s = z.sqrt();
    z = -s;
    take_exponentials(z);
    z *= 1.0 + s + s.square() / 3.0;
  }
  void slopes(Numbers z, Numbers slope) const {
    const Block s = z.sqrt();
    slope = -s;
    take_exponentials(slope);
    z = (1.0 + s + s.square() / 3.0) * slope;
    slope *= (5.0 / 3.0) * (1.0 + s);
  }
  void bends(Numbers z) const {
    const Block s = z.sqrt();
    z = -s;
    take_exponentials(z);
    z *= (5.0 / 3.0) * (1.0 + s - s.square());
  }
};

using Matern52 = StationaryKernel<Matern52Shape>;
PALPATE_PLUGIN(Kernel, Matern52, "matern52", "Matern 5/2: smooth surfaces that are differentiable twice")

}  // namespace palpate::kernels
