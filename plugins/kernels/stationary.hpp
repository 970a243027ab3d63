// SPDX-License-Identifier: MIT
// What the stationary kernels share: one length scale, and a covariance that is a function of the scaled distance.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

namespace palpate::kernels {

struct StationaryOptions : Options {
  double length_scale = 0.017;

  void list(Fields& fields) override {
    fields.real(length_scale,
                Field("length_scale", "distance over which heights stay alike")
                    .in(Unit::metre)
                    .above(0)
                    .from("Sun and Min 2021 give 'sigma^2 = 0.017' without unit; 1.7 cm reproduces their counts"));
  }
};

/// A kernel of unit variance k(a, b) = Shape::of(r^2), r = |a - b| / length_scale. `Shape` maps an array of squared
/// scaled distances to covariances in place.
template <class Shape>
class Stationary final : public Kernel {
 public:
  using Options = StationaryOptions;

  Stationary(const Options& options, const Context&) : length_scale_(options.length_scale) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      auto column = out.col(j).array();
      // Dividing before squaring keeps r^2 finite for any representable pair of length scale and distance.
      column = ((a.col(0).array() - b(j, 0)) / length_scale_).square() +
               ((a.col(1).array() - b(j, 1)) / length_scale_).square();
      Shape::apply(column);
    }
  }

  void variance(const PointsView& a, VectorOut out) const override { out.head(a.rows()).setOnes(); }

  std::vector<KernelParameter> parameters() const override { return {{"length_scale", length_scale_}}; }

 private:
  double length_scale_;
};

}  // namespace palpate::kernels
