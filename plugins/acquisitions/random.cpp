// SPDX-License-Identifier: MIT
// Baseline with random scores, uniform in (0, 1). The best candidate is therefore a uniform draw.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class RandomSearch final : public Acquisition {
 public:
  using Options = NoOptions;
  RandomSearch(const Options&, const Context& context) : seed_(context.seed) {}

  QuantitySet reads() const override { return {}; }
  /// Each tap has a separate stream of random numbers. The score therefore stays a pure function of the belief, and a
  /// resumed run draws the same numbers.
  void score(const BeliefView& belief, VectorOut out) const override {
    Random random(seed_, "acquisition/random", static_cast<std::uint64_t>(belief.taps().count));
    for (double& one : out) one = random.uniform() + 0x1.0p-54;
  }
  double prior_scale() const override { return 0.0; }

 private:
  std::uint64_t seed_;
};

PALPATE_PLUGIN(Acquisition, RandomSearch, "random", "random candidates, as a baseline")

}  // namespace palpate::acquisitions
