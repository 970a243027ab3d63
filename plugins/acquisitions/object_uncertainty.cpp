// SPDX-License-Identifier: MIT
// Uncertainty of the height where an object is: the standard deviation, relative to the prior, weighted by the
// footprint's probability. The paper weighs the variance; beside the entropy of an outline that one fades too soon.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class ObjectUncertainty final : public Acquisition {
 public:
  using Options = NoOptions;
  ObjectUncertainty(const Options&, const Context&) {}

  Quantities reads() const override { return Quantity::uncertainty | Quantity::probability; }
  void score(const Belief& belief, VectorOut out) const override {
    out = belief.uncertainty().cwiseMax(0.0).cwiseSqrt().cwiseProduct(belief.probability());
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, ObjectUncertainty, "object_uncertainty",
               "standard deviation of the height times the probability of an object")

}  // namespace palpate::acquisitions
