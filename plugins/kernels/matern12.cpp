// SPDX-License-Identifier: MIT
// Matern kernel with nu = 1/2, the exponential: k = exp(-r) (Rasmussen and Williams 2006, section 4.2).
#include "stationary.hpp"

namespace palpate::kernels {

struct Matern12Shape : PlainShape {
  using PlainShape::PlainShape;

  template <class Array>
  void apply(Array r2) const {
    r2 = (-r2.sqrt()).exp();
  }
  void slopes(const Chunk& r2, Chunk& k, Chunk& g) const {
    const Chunk r = r2.sqrt();
    k = (-r).exp();
    // At r = 0 the slope by the length scale, g r^2, is 0; the bound keeps g finite there.
    g = k / r.max(1e-150);
  }
};

using Matern12 = Stationary<Matern12Shape>;
PALPATE_PLUGIN(Kernel, Matern12, "matern12", "Matern 1/2: rough surfaces, without a slope anywhere")

}  // namespace palpate::kernels
