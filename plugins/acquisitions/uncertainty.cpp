// SPDX-License-Identifier: MIT
// Tap where the height is least known: score = u, the posterior variance (Yi et al., IROS 2016; the paper's rival).
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Uncertainty final : public Acquisition {
 public:
  using Options = NoOptions;
  Uncertainty(const Options&, const Context&) {}

  Quantities reads() const override { return Quantity::uncertainty; }
  void score(const Belief& belief, VectorOut out) const override { out = belief.uncertainty(); }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Uncertainty, "uncertainty", "tap where the height is least known")

}  // namespace palpate::acquisitions
