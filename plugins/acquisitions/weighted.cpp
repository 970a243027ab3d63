// SPDX-License-Identifier: MIT
// The paper's exploration function: e(x) = u(x) w(x) (Sun and Min 2021, section III), with w as it comes from the
// label GP. Its prior mean and its clipping are options of that process: `label: {prior_mean, clip}`.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Weighted final : public Acquisition {
 public:
  using Options = NoOptions;
  Weighted(const Options&, const Context&) {}

  Quantities reads() const override { return Quantity::uncertainty | Quantity::weight; }
  void score(const Belief& belief, VectorOut out) const override {
    out = belief.uncertainty().cwiseProduct(belief.weight());
  }
  /// u is 1 before any tap and w is a probability in the model's mind.
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Weighted, "weighted",
               "variance of the height times the mean of the label GP, as in the paper")

}  // namespace palpate::acquisitions
