// SPDX-License-Identifier: MIT
// From any side, tap where most is expected to come of it, in metres of the mean distance: a piece that nobody has
// touched yet is found, or the surface that is believed is known better.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Discovery final : public Acquisition {
 public:
  using Options = NoOptions;
  Discovery(const Options&, const Context&) {}

  bool from_above() const override { return false; }
  bool any_side() const override { return true; }
  Quantities reads() const override { return {}; }
  Quantities reads_of_approaches() const override { return Quantity::unseen | Quantity::reduction; }
  void score(const Belief&, VectorOut out) const override { out.setZero(); }
  double prior_scale() const override { return 0.001; }

  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override {
    out = belief.unseen() + belief.reduction();
  }
};

PALPATE_PLUGIN(Acquisition, Discovery, "discovery", "from any side, tap where most is expected to be found")

}  // namespace palpate::acquisitions
