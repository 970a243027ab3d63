// SPDX-License-Identifier: MIT
// Relative posterior variance u of the height (Yi et al., IROS 2016; Sun and Min 2021 compare it with `weighted`). For
// taps from any side: variance of the surface along its normal (after Caccamo et al., RIL 2016: GPAtlasRRT).
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Uncertainty final : public Acquisition {
 public:
  using Options = NoOptions;
  Uncertainty(const Options&, const Context&) {}

  QuantitySet reads() const override { return {quantity::kUncertainty}; }
  void score(const BeliefView& belief, VectorOut out) const override { out = belief.values(quantity::kUncertainty); }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Uncertainty, "uncertainty",
               "variance of the height; for taps from any side, variance of the surface along its normal")

}  // namespace palpate::acquisitions
