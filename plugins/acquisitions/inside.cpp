// SPDX-License-Identifier: MIT
// Height variance where an object is: u weighted by the footprint's probability, as the paper weighs it by w.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Inside final : public Acquisition {
 public:
  using Options = NoOptions;
  Inside(const Options&, const Context&) {}

  void score(const Belief& belief, VectorOut out) const override {
    out = belief.uncertainty().cwiseProduct(belief.probability());
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Inside, "inside", "tap where the height is unknown and an object is probable")

}  // namespace palpate::acquisitions
