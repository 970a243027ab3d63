// SPDX-License-Identifier: MIT
// Entropy of the footprint in bits. The entropy is largest where the presence of an object is least certain. If the
// footprint consists of whole outlines, these positions are at uncertain edges.
#include <palpate/acquisition.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <cmath>

namespace palpate::acquisitions {

class FootprintEntropy final : public Acquisition {
 public:
  using Options = NoOptions;
  FootprintEntropy(const Options&, const Context&) {}

  QuantitySet reads() const override { return {quantity::kObjectProbability}; }
  void score(const BeliefView& belief, VectorOut out) const override {
    const auto bits = [](double p) { return p > 0.0 ? -p * math::log2(p) : 0.0; };
    out = belief.values(quantity::kObjectProbability).unaryExpr([&](double p) { return bits(p) + bits(1.0 - p); });
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, FootprintEntropy, "footprint_entropy",
               "entropy of the footprint, which is largest where the presence of an object is least certain")

}  // namespace palpate::acquisitions
