// SPDX-License-Identifier: MIT
// Matern kernel with nu = 3/2: k = (1 + s) exp(-s), s = sqrt(3) r (Rasmussen and Williams 2006, equation 4.17).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern32Shape : PlainShape {
  using PlainShape::PlainShape;

  template <class Array>
  void apply(Array r2) const {
    r2 = (3.0 * r2).sqrt();
    // exp(-s) underflows to 0 long before s overflows; without the bound, infinity times 0 would be NaN.
    r2 = r2.min(800.0);
    r2 = (1.0 + r2) * (-r2).exp();
  }
  void slopes(const Chunk& r2, Chunk& k, Chunk& g) const {
    const Chunk s = (3.0 * r2).sqrt();
    g = (-s).exp();
    k = (1.0 + s) * g;
    g *= 3.0;
  }
};

using Matern32 = Stationary<Matern32Shape>;
PALPATE_PLUGIN(Kernel, Matern32, "matern32", "Matern 3/2: surfaces with a slope everywhere, but rough")

}  // namespace palpate::kernels
