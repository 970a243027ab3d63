// SPDX-License-Identifier: MIT
// Acquisition for taps from any side: expected gain in metres of mean surface distance, from the discovery of untouched
// parts or from smaller uncertainty of the known surface.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

struct DiscoveryOptions : Options {
  double travel_cost_exponent = 0.0;
  void list(Fields& fields) override {
    fields.real(travel_cost_exponent,
                Field("travel_cost_exponent",
                      "exponent of the expected path length. The score is divided by the path length to this exponent. "
                      "0 maximises the gain per tap, and 1 maximises the gain per metre")
                    .at_least(0)
                    .at_most(1));
  }
};

class Discovery final : public Acquisition {
 public:
  using Options = DiscoveryOptions;
  Discovery(const Options& options, const Context&) : options_(options) {}

  bool from_above() const override { return false; }
  bool any_side() const override { return true; }
  Quantities reads() const override { return {}; }
  Quantities reads_of_approaches() const override { return Quantity::expected_discovery | Quantity::std_reduction; }
  void score(const Belief&, VectorOut out) const override { out.setZero(); }
  double prior_scale() const override { return 0.001; }

  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override {
    constexpr double kUsual = 0.3;  // metres, usual path length
    out = belief.expected_discovery() + belief.std_reduction();
    if (options_.travel_cost_exponent > 0.0)
      out.array() /= (belief.way().array() / kUsual).max(0.1).pow(options_.travel_cost_exponent);
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Acquisition, Discovery, "discovery",
               "expected discovery of new surface plus reduction of uncertainty, for taps from any side")

}  // namespace palpate::acquisitions
