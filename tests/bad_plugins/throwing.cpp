// SPDX-License-Identifier: MIT
// Acquisition or footprint that loads correctly and throws when used. The run must end in good order.
#include <palpate/acquisition.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <stdexcept>

namespace broken {

struct OwnException final : std::exception {
  const char* what() const noexcept override { return "no score today"; }
};

#ifdef THROWS_WHEN_TOLD
class Footprint final : public palpate::Footprint {
 public:
  using Options = palpate::NoOptions;
  Footprint(const Options&, const palpate::Context&) {}
  void add(const palpate::Touch&) override {
    if (++touches_ == 3) throw std::runtime_error("no touch today");
  }
  void probability(const palpate::PointsView&, palpate::VectorOut out) override { out.setConstant(0.5); }

 private:
  int touches_ = 0;
};

PALPATE_PLUGIN(palpate::Footprint, Footprint, PLUGIN_NAME, "throws when it is told of the third touch")
#else
class Acquisition final : public palpate::Acquisition {
 public:
  using Options = palpate::NoOptions;
  Acquisition(const Options&, const palpate::Context&) {}
  palpate::QuantitySet reads() const override { return {palpate::quantity::kUncertainty}; }
  void score([[maybe_unused]] const palpate::BeliefView& belief,
             [[maybe_unused]] palpate::VectorOut out) const override {
#ifdef THROWS_NUMBER
    throw 42;
#elif defined(READS_UNTOLD)
    out = belief.values(palpate::quantity::kUncertainty) + belief.values(palpate::quantity::kLabelMean);
#else
    throw OwnException();
#endif
  }
  double prior_scale() const override { return 1.0; }
};

PALPATE_PLUGIN(palpate::Acquisition, Acquisition, PLUGIN_NAME, "throws when asked for a score")
#endif

}  // namespace broken
