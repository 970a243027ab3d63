// Score of each candidate: uncertainty u of the height times object probability p to the power `trust`, u * p^trust.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

using namespace palpate;

struct MyAcquisitionOptions : Options {
  double trust = 0.5;

  void list(Fields& fields) override {
    fields.real(
        trust,
        Field("trust", "exponent of the object probability. At 0, only the height uncertainty counts").within(0, 10));
  }
};

class MyAcquisition final : public Acquisition {
 public:
  using Options = MyAcquisitionOptions;
  MyAcquisition(const Options& options, const Context&) : options_(options) {}

  QuantitySet reads() const override { return {quantity::kUncertainty, quantity::kObjectProbability}; }

  void score(const BeliefView& belief, VectorOut out) const override {
    const auto probability = belief.values(quantity::kObjectProbability).array();
    out = belief.values(quantity::kUncertainty).array() * probability.pow(options_.trust);
  }

  double prior_scale() const override { return 1.0; }

 private:
  Options options_;
};

PALPATE_PLUGIN(Acquisition, MyAcquisition, "starter", "custom acquisition: height uncertainty times object probability")
