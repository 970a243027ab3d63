// SPDX-License-Identifier: MIT
// Exploration function e(x) = u(x) * w(x) of Sun and Min 2021, section III. u is the relative variance of the height
// GP, and w is the mean of the label GP. The options `label: {prior_mean, clip}` set the prior mean and the clipping of
// w.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class WeightedAcquisition final : public Acquisition {
 public:
  using Options = NoOptions;
  WeightedAcquisition(const Options&, const Context&) {}

  QuantitySet reads() const override { return {quantity::kUncertainty, quantity::kLabelMean}; }
  void score(const BeliefView& belief, VectorOut out) const override {
    out = belief.values(quantity::kUncertainty).cwiseProduct(belief.values(quantity::kLabelMean));
  }
  /// Before any tap, u is 1 and w is a probability.
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, WeightedAcquisition, "weighted",
               "variance of the height times the mean of the label GP, as in the paper")

}  // namespace palpate::acquisitions
