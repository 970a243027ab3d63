// SPDX-License-Identifier: MIT
// Standard deviation of the height relative to the prior, times the probability of an object. The paper uses the
// variance, which decreases too fast compared with the entropy of an outline.
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
