// SPDX-License-Identifier: MIT
// The squared-exponential kernel of the paper, k = exp(-r^2 / 2) (Sun and Min 2021, section III).
#include "stationary.hpp"

namespace palpate::kernels {

struct RbfShape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSeparable = true;

  template <class Array>
  void apply(Array r2) const {
    r2 = (-0.5 * r2).exp();
  }
  void slopes(const Chunk& r2, Chunk& k, Chunk& g) const {
    k = (-0.5 * r2).exp();
    g = k;
  }
};

using Rbf = Stationary<RbfShape>;
PALPATE_PLUGIN(Kernel, Rbf, "rbf", "squared exponential: very smooth surfaces, the paper's choice")

}  // namespace palpate::kernels
