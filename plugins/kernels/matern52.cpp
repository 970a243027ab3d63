// SPDX-License-Identifier: MIT
// Matern kernel with nu = 5/2: k = (1 + s + s^2 / 3) exp(-s), s = sqrt(5) r (Rasmussen and Williams 2006, eq. 4.17).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern52Shape : PlainShape {
  using PlainShape::PlainShape;

  template <class Array>
  void apply(Array r2) const {
    r2 = (5.0 * r2).sqrt();
    // exp(-s) underflows to 0 long before s overflows; without the bound, infinity times 0 would be NaN.
    r2 = r2.min(800.0);
    r2 = (1.0 + r2 + r2.square() / 3.0) * (-r2).exp();
  }
  void slopes(const Chunk& r2, Chunk& k, Chunk& g) const {
    const Chunk s = (5.0 * r2).sqrt();
    g = (-s).exp();
    k = (1.0 + s + s.square() / 3.0) * g;
    g *= (5.0 / 3.0) * (1.0 + s);
  }
};

using Matern52 = Stationary<Matern52Shape>;
PALPATE_PLUGIN(Kernel, Matern52, "matern52", "Matern 5/2: smooth surfaces with some roughness")

}  // namespace palpate::kernels
