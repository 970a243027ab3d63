// Covariance of the heights at two positions with distance r: k = 1 / (1 + (r / length_scale)^2).
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

using namespace palpate;

struct MyKernelOptions : Options {
  double length_scale = 0.02;

  void list(Fields& fields) override {
    fields.real(
        length_scale,
        Field("length_scale", "length scale, the distance over which heights are correlated").in(Unit::metre).above(0));
  }
};

class MyKernel final : public Kernel {
 public:
  using Options = MyKernelOptions;
  MyKernel(const Options& options, const Context&) : options_(options) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      auto r2 = out.col(j);
      r2 = ((a.rowwise() - b.row(j)) / options_.length_scale).rowwise().squaredNorm();
      r2 = (1 + r2.array()).inverse();
    }
  }

  void variance(const PointsView&, VectorOut out) const override { out.setOnes(); }

  std::vector<KernelParameter> parameters() const override { return {{"length_scale", options_.length_scale}}; }

 private:
  Options options_;
};

PALPATE_PLUGIN(Kernel, MyKernel, "starter", "custom kernel: correlation that decays slowly with distance")
