// SPDX-License-Identifier: MIT
// A kernel, exp(-(r / (reach * stretch))^power), in three versions. VERSION 2 adds an option. VERSION 3 has another
// order and another default, removes an option and renames one.
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

namespace palpate::test {
namespace {

struct VersionedOptions : Options {
  double reach = VERSION < 3 ? 0.017 : 0.03;
  double stretch = 1.0;
  double tolerance = 1e-8;
  double power = VERSION < 3 ? 2.0 : 1.5;
  bool verbose = false;

  void list(Fields& fields) override {
    const auto add_reach = [&] { fields.real(reach, Field("reach", "of the kernel").in(Unit::metre).above(0)); };
    if (VERSION < 3) {
      add_reach();
      fields.real(stretch, Field("stretch", "of the reach").above(0));
      fields.real(tolerance, Field("tolerance", "of nothing").at_least(0));
    }
    if (VERSION > 1) fields.real(power, Field("power", "of the distance").above(0).at_most(2).neutral(2.0));
    if (VERSION > 2) {
      fields.real(stretch, Field("scaling", "of the reach").above(0).was("stretch"));
      fields.retired(Field("tolerance", "nothing has taken its place"), 1e-8);
      add_reach();
    }
    fields.flag(verbose, Field("verbose", "says nothing more").not_identifying());
  }
};

}  // namespace

class Versioned final : public Kernel {
 public:
  using Options = VersionedOptions;
  Versioned(const Options& options, const Context&) : options_(options) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    const double reach = options_.reach * options_.stretch;
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      out.col(j) = ((a.rowwise() - b.row(j)) / reach).rowwise().norm();
      out.col(j) = (-out.col(j).array().pow(options_.power)).exp();
    }
  }
  void variance(const PointsView&, VectorOut out) const override { out.setOnes(); }
  std::vector<KernelParameter> parameters() const override { return {{"reach", options_.reach}}; }

 private:
  Options options_;
};

PALPATE_PLUGIN(Kernel, Versioned, "versioned", "a kernel of several versions")

}  // namespace palpate::test
