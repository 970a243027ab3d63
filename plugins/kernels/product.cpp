// SPDX-License-Identifier: MIT
// Product of kernels. Heights are correlated only if every factor correlates them. An example is one factor per axis.
#include "composed.hpp"

namespace palpate::kernels {

struct Multiply {
  static constexpr double kNothing = 1.0;

  template <class Whole, class Part>
  static void apply(Whole whole, const Part& part) {
    whole *= part;
  }
  /// Computes the derivatives of a product: the derivatives of this part times the previous values, and the previous
  /// derivatives times the values of this part. The product rule is used without division, so values of 0 cause no
  /// error.
  template <class Slopes, class Own>
  static void join_slopes(Slopes before, Own& own, const MatrixOut& whole, const Eigen::MatrixXd& part) {
    const Eigen::Index m = whole.cols();
    for (Eigen::Index p = 0; p < own.cols(); p += m) own.middleCols(p, m).array() *= whole.array();
    for (Eigen::Index p = 0; p < before.cols(); p += m) before.middleCols(p, m).array() *= part.array();
  }
};

class Product final : public ComposedKernel<Multiply> {
 public:
  using ComposedKernel::ComposedKernel;

  bool separable() const override {
    return std::all_of(parts_.begin(), parts_.end(), [](const auto& one) { return one->separable(); });
  }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    parts_[0]->axis_covariance(axis, a, b, out);
    // Views go by value. NOLINTNEXTLINE(performance-unnecessary-value-param)
    join_others(out, [&](const Kernel& part, Eigen::Index j, VectorOut own) {
      part.axis_covariance(axis, a, b.segment(j, 1), own);
    });
  }
};

PALPATE_PLUGIN(Kernel, Product, "product",
               "product of kernels. Two points are correlated only if every factor correlates the points")

}  // namespace palpate::kernels
