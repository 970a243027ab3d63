// SPDX-License-Identifier: MIT
// A sum of kernels: surfaces that add up, for example a broad swell and fine texture.
#include "composed.hpp"

namespace palpate::kernels {

struct Add {
  template <class Whole>
  static void apply(Whole whole, const Piece& part) {
    whole += part;
  }
};

class Sum final : public Composed<Add> {
 public:
  using Composed::Composed;

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for_pieces(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
      Eigen::Index first = 0;
      Piece part(count);
      auto sum = value.segment(from, count).array();
      sum.setZero();
      for (std::size_t i = 0; i < parts().size(); ++i) {
        const Eigen::Index own = parts().parameters_of(i);
        parts()[i].derivatives(a.middleRows(from, count), b, part.matrix(), slopes.block(from, first, count, own));
        sum += part;
        first += own;
      }
    });
  }
};

PALPATE_PLUGIN(Kernel, Sum, "sum", "sum of kernels: surfaces that add up")

}  // namespace palpate::kernels
