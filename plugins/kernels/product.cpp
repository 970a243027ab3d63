// SPDX-License-Identifier: MIT
// A product of kernels: heights are alike only where every part says so, for example one part for each axis.
#include "composed.hpp"

namespace palpate::kernels {

class Product final : public Kernel {
 public:
  using Options = PartsOptions;

  Product(const Options& options, const Context& context) : parts_(options, context) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    parts_[0].covariance(a, b, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
          Chunk factor(count);
          parts_[i].covariance(a.middleRows(from, count), b.row(j), factor);
          out.col(j).segment(from, count).array() *= factor.array();
        });
      }
    }
  }

  void variance(const PointsView& a, VectorOut out) const override {
    parts_[0].variance(a, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
        Chunk factor(count);
        parts_[i].variance(a.middleRows(from, count), factor);
        out.segment(from, count).array() *= factor.array();
      });
    }
  }

  std::vector<KernelParameter> parameters() const override { return parts_.parameters(); }
  bool differentiable() const override { return parts_.differentiable(); }
  void set_parameters(const VectorView& values) override { parts_.set_parameters(values); }

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
      Eigen::Index first = 0;
      Chunk factor(count);
      auto product = value.segment(from, count);
      product.setOnes();
      auto rows = slopes.middleRows(from, count);
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Eigen::Index own = parts_.parameters_of(i);
        parts_[i].derivatives(a.middleRows(from, count), b, factor, slopes.block(from, first, count, own));
        // The slopes of this part times the values of those before it, and theirs times its value: no division, so
        // that a value of 0 does no harm.
        rows.middleCols(first, own).array().colwise() *= product.array();
        rows.leftCols(first).array().colwise() *= factor.array();
        product.array() *= factor.array();
        first += own;
      }
    });
  }

 private:
  Parts parts_;
};

PALPATE_PLUGIN(Kernel, Product, "product", "product of kernels: alike only where every part says so")

}  // namespace palpate::kernels
