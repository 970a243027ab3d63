// SPDX-License-Identifier: MIT
// Acquisition for taps from any side. The score is the expected decrease of the mean surface distance by the tap, in
// metres. A tap decreases this distance in two ways: it finds untouched parts, and it reduces the uncertainty of the
// known surface.
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
                    .within(0, 1));
  }
};

class Discovery final : public Acquisition {
 public:
  using Options = DiscoveryOptions;
  Discovery(const Options& options, const Context&) : options_(options) {}

  QuantitySet reads() const override {
    QuantitySet out{quantity::kExpectedDiscovery, quantity::kStdReduction};
    if (options_.travel_cost_exponent > 0.0) out.insert(quantity::kExpectedDistance);
    return out;
  }
  double prior_scale() const override { return 0.001; }

  void score(const BeliefView& belief, VectorOut out) const override {
    constexpr double kUsual = 0.3;  // typical path length, metres
    out = belief.values(quantity::kExpectedDiscovery) + belief.values(quantity::kStdReduction);
    if (options_.travel_cost_exponent > 0.0) {
      const auto distance = belief.values(quantity::kExpectedDistance).array();
      out.array() /= (distance / kUsual).max(0.1).pow(options_.travel_cost_exponent);
    }
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Acquisition, Discovery, "discovery",
               "expected discovery of new surface plus reduction of uncertainty, for taps from any side")

}  // namespace palpate::acquisitions
