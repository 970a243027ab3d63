// SPDX-License-Identifier: MIT
// A sum of kernels: surfaces that add up, for example a broad swell and fine texture.
#include "composed.hpp"

namespace palpate::kernels {

class Sum final : public Kernel {
 public:
  using Options = PartsOptions;

  Sum(const Options& options, const Context& context) : parts_(options, context) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    parts_[0].covariance(a, b, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
          Chunk term(count);
          parts_[i].covariance(a.middleRows(from, count), b.row(j), term);
          out.col(j).segment(from, count) += term;
        });
      }
    }
  }

  void variance(const PointsView& a, VectorOut out) const override {
    parts_[0].variance(a, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
        Chunk term(count);
        parts_[i].variance(a.middleRows(from, count), term);
        out.segment(from, count) += term;
      });
    }
  }

  std::vector<KernelParameter> parameters() const override { return parts_.parameters(); }
  bool differentiable() const override { return parts_.differentiable(); }
  void set_parameters(const VectorView& values) override { parts_.set_parameters(values); }

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for_chunks(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
      Eigen::Index first = 0;
      Chunk term(count);
      value.segment(from, count).setZero();
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Eigen::Index own = parts_.parameters_of(i);
        parts_[i].derivatives(a.middleRows(from, count), b, term, slopes.block(from, first, count, own));
        value.segment(from, count) += term;
        first += own;
      }
    });
  }

 private:
  Parts parts_;
};

PALPATE_PLUGIN(Kernel, Sum, "sum", "sum of kernels: surfaces that add up")

}  // namespace palpate::kernels
