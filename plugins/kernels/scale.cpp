// SPDX-License-Identifier: MIT
// A kernel multiplied by a constant, for example as a term of a sum.
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

namespace palpate::kernels {

struct ScaleOptions : Options {
  double factor = 1.0;
  PluginChoice kernel{"kernel", {}, nullptr};

  void list(Fields& fields) override {
    fields.real(factor, Field("factor", "factor by which covariances are multiplied").within(1e-12, 1e12));
    fields.plugin(kernel, Field("kernel", "kernel to multiply, written as {type: ..., ...}").needed());
  }
};

class Scale final : public Kernel {
 public:
  using Options = ScaleOptions;

  Scale(const Options& options, const Context& context)
      : factor_(options.factor), inner_(context.create<Kernel>(options.kernel)) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    inner_->covariance(a, b, out);
    out *= factor_;
  }

  void variance(const PointsView& a, VectorOut out) const override {
    inner_->variance(a, out);
    out *= factor_;
  }

  bool separable() const override { return inner_->separable(); }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    inner_->axis_covariance(axis, a, b, out);
    if (axis == 0) out *= factor_;
  }

  std::vector<KernelParameter> parameters() const override {
    std::vector<KernelParameter> out{{"factor", factor_}};
    for (KernelParameter one : inner_->parameters()) {
      one.name = "kernel." + one.name;
      out.push_back(std::move(one));
    }
    return out;
  }

  bool differentiable() const override { return inner_->differentiable(); }

  void set_parameters(const VectorView& values) override {
    factor_ = values(0);
    inner_->set_parameters(values.tail(values.size() - 1));
  }

  void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const override {
    auto inner = slopes.rightCols(slopes.cols() - b.rows());
    inner_->derivatives(a, b, value, inner);
    value *= factor_;
    inner *= factor_;
    slopes.leftCols(b.rows()) = value;  // d k / d log factor = k
  }

 private:
  double factor_;
  std::shared_ptr<Kernel> inner_;
};

PALPATE_PLUGIN(Kernel, Scale, "scale", "kernel times a constant factor, for example for a term of a sum of kernels")

}  // namespace palpate::kernels
