// SPDX-License-Identifier: MIT
// An acquisition that can be loaded and made, and throws when it is used: what the run must survive in good order.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace broken {

struct OwnException final : std::exception {
  const char* what() const noexcept override { return "no score today"; }
};

class Acquisition final : public palpate::Acquisition {
 public:
  using Options = palpate::NoOptions;
  Acquisition(const Options&, const palpate::Context&) {}
  palpate::Quantities reads() const override { return palpate::Quantity::uncertainty; }
  void score([[maybe_unused]] const palpate::Belief& belief, [[maybe_unused]] palpate::VectorOut out) const override {
#ifdef THROWS_NUMBER
    throw 42;
#elif defined(READS_UNTOLD)
    out = belief.uncertainty() + belief.weight();
#else
    throw OwnException();
#endif
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(palpate::Acquisition, Acquisition, PLUGIN_NAME, "throws when asked for a score")

}  // namespace broken
