// Rational quadratic kernel: k = (1 + r^2 / (2 alpha))^-alpha (Rasmussen and Williams 2006, equation 4.19).
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

using namespace palpate;

struct RationalOptions : Options {
  double length_scale = 0.02;
  double alpha = 1.0;

  void list(Fields& fields) override {
    fields.real(length_scale,
                Field("length_scale", "distance over which heights are correlated").in(Unit::metre).above(0));
    fields.real(alpha,
                Field("alpha", "shape parameter. Small values mix many length scales").at_least(0.01).at_most(1e6));
  }
};

class Rational final : public Kernel {
 public:
  using Options = RationalOptions;
  Rational(const Options& options, const Context&) : options_(options) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      auto r2 = out.col(j);
      r2 = ((a.rowwise() - b.row(j)) / options_.length_scale).rowwise().squaredNorm();
      r2 = (1 + r2.array() / (2 * options_.alpha)).pow(-options_.alpha);
    }
  }

  void variance(const PointsView&, VectorOut out) const override { out.setOnes(); }

  std::vector<KernelParameter> parameters() const override {
    return {{"length_scale", options_.length_scale}, {"alpha", options_.alpha}};
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Kernel, Rational, "rational", "rational quadratic: several length scales at once")
