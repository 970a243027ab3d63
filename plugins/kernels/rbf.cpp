// SPDX-License-Identifier: MIT
// Squared-exponential kernel of Sun and Min 2021, section III: k = exp(-r^2 / 2).
#include "stationary/stationary.hpp"

namespace palpate::kernels {

struct RbfShape : PlainShape {
  using PlainShape::PlainShape;
  static constexpr bool kSeparable = true;
  static constexpr bool kSlopes = true;

  static constexpr double kScale = -0.5;
  void values(Numbers z) const { take_exponentials(z); }
  void slopes(Numbers z, Numbers slope) const {
    take_exponentials(z);
    slope = z;
  }
  void bends(Numbers z) const {
    const Block r2 = -2.0 * z;
    take_exponentials(z);
    z *= 1.0 - r2;
  }
};

using Rbf = StationaryKernel<RbfShape>;
PALPATE_PLUGIN(Kernel, Rbf, "rbf", "squared exponential: very smooth surfaces, as in the paper")

}  // namespace palpate::kernels
