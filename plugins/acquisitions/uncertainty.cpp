// SPDX-License-Identifier: MIT
// Relative posterior variance u of the height (Yi et al., IROS 2016; compared in the paper). For taps from any side:
// variance of the surface along its normal (after Caccamo et al., RIL 2016: GPAtlasRRT).
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Uncertainty final : public Acquisition {
 public:
  using Options = NoOptions;
  Uncertainty(const Options&, const Context&) {}

  Quantities reads() const override { return Quantity::uncertainty; }
  void score(const Belief& belief, VectorOut out) const override { out = belief.uncertainty(); }
  bool any_side() const override { return true; }
  Quantities reads_of_approaches() const override { return Quantity::deviation; }
  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override {
    constexpr double kAlong = 0.999;
    const double most = belief.deviation().maxCoeff();
    const double scale = most > 0.0 ? 1.0 / most : 0.0;  // scales scores to 1, as the tie tolerance expects
    out = (belief.incidence_cosine().array() > kAlong).select((scale * belief.deviation().array()).square(), 0.0);
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Uncertainty, "uncertainty",
               "variance of the height; for taps from any side, variance of the surface along its normal")

}  // namespace palpate::acquisitions
