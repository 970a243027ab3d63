// SPDX-License-Identifier: MIT
// Sum of kernels. It models a surface that is a sum of surfaces, for example a smooth surface with fine texture.
#include "composed.hpp"

namespace palpate::kernels {

struct Add {
  static constexpr double kNothing = 0.0;

  template <class Whole, class Part>
  static void apply(Whole whole, const Part& part) {
    whole += part;
  }
  template <class Slopes, class Own>
  static void join_slopes(const Slopes&, const Own&, const MatrixOut&, const Eigen::MatrixXd&) {}
};

using Sum = ComposedKernel<Add>;
PALPATE_PLUGIN(Kernel, Sum, "sum", "sum of kernels, for a surface that is the sum of independent surfaces")

}  // namespace palpate::kernels
