// SPDX-License-Identifier: MIT
// Tap where an object most probably is: the fastest way to a first hit.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

class Likely final : public Acquisition {
 public:
  using Options = NoOptions;
  Likely(const Options&, const Context&) {}

  void score(const Belief& belief, VectorOut out) const override { out = belief.probability(); }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(Acquisition, Likely, "likely", "tap where an object most probably is")

}  // namespace palpate::acquisitions
