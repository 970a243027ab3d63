// SPDX-License-Identifier: MIT
// Baseline: scores are uniform in (0, 1), so the best candidate is a uniform draw.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class RandomSearch final : public Acquisition {
 public:
  using Options = NoOptions;
  RandomSearch(const Options&, const Context& context) : seed_(context.seed) {}

  Quantities reads() const override { return {}; }
  void score(const Belief& belief, VectorOut out) const override { draw(belief.taps(), out); }
  bool any_side() const override { return true; }
  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override { draw(belief.taps(), out); }
  double prior_scale() const override { return 0.0; }

 private:
  /// Draws from one stream per tap. So scores are a pure function of the belief, and a resumed run draws the same ones.
  void draw(int taps, VectorOut out) const {
    Random random(seed_, "acquisition/random", static_cast<std::uint64_t>(taps));
    for (double& one : out) one = random.uniform() + 0x1.0p-54;
  }

  std::uint64_t seed_;
};

PALPATE_PLUGIN(Acquisition, RandomSearch, "random", "random candidates, as a baseline")

}  // namespace palpate::acquisitions
