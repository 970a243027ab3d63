// SPDX-License-Identifier: MIT
// A product of kernels: heights are alike only where every part says so, for example one part for each axis.
#include "composed.hpp"

namespace palpate::kernels {

struct Multiply {
  template <class Whole>
  static void apply(Whole whole, const Piece& part) {
    whole *= part;
  }
};

class Product final : public Composed<Multiply> {
 public:
  using Composed::Composed;

  bool separable() const override {
    bool all = true;
    for (std::size_t i = 0; i < parts().size(); ++i) all &= parts()[i].separable();
    return all;
  }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    parts()[0].axis_covariance(axis, a, b, out);
    for (std::size_t i = 1; i < parts().size(); ++i) {
      for (Eigen::Index j = 0; j < b.size(); ++j) {
        for_pieces(a.size(), [&](Eigen::Index from, Eigen::Index count) {
          Piece part(count);
          parts()[i].axis_covariance(axis, a.segment(from, count), b.segment(j, 1), part.matrix());
          out.col(j).segment(from, count).array() *= part;
        });
      }
    }
  }

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for_pieces(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
      Eigen::Index first = 0;
      Piece factor(count);
      auto product = value.segment(from, count).array();
      product.setOnes();
      auto rows = slopes.middleRows(from, count);
      for (std::size_t i = 0; i < parts().size(); ++i) {
        const Eigen::Index own = parts().parameters_of(i);
        parts()[i].derivatives(a.middleRows(from, count), b, factor.matrix(), slopes.block(from, first, count, own));
        // The slopes of this part times the values of those before it, and theirs times its value: no division, so
        // that a value of 0 does no harm.
        rows.middleCols(first, own).array().colwise() *= product;
        rows.leftCols(first).array().colwise() *= factor;
        product *= factor;
        first += own;
      }
    });
  }
};

PALPATE_PLUGIN(Kernel, Product, "product", "product of kernels: alike only where every part says so")

}  // namespace palpate::kernels
