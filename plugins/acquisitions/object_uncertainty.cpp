// SPDX-License-Identifier: MIT
// Standard deviation of the height relative to the prior, multiplied by the probability of an object. Sun and Min 2021
// use the variance. In a sum with the entropy of the footprint, the variance would decrease too fast compared with this
// entropy.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class ObjectUncertainty final : public Acquisition {
 public:
  using Options = NoOptions;
  ObjectUncertainty(const Options&, const Context&) {}

  QuantitySet reads() const override { return {quantity::kUncertainty, quantity::kObjectProbability}; }
  void score(const BeliefView& belief, VectorOut out) const override {
    const Eigen::VectorXd& probability = belief.values(quantity::kObjectProbability);
    out = belief.values(quantity::kUncertainty).cwiseMax(0.0).cwiseSqrt().cwiseProduct(probability);
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, ObjectUncertainty, "object_uncertainty",
               "standard deviation of the height times the probability of an object")

}  // namespace palpate::acquisitions
