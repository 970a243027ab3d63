// SPDX-License-Identifier: MIT
// Backend of a robot that stops after its fifth tap until a person has checked it, as after a safety fault. The next
// process finds it repaired. It also displays the belief.
#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

namespace broken {

class Backend final : public palpate::Backend {
 public:
  using Options = palpate::NoOptions;
  static constexpr bool kOneAtATime = true;
  Backend(const Options&, const palpate::Context&) {}

  palpate::TapResult tap(const palpate::TapRequest& request) override {
    if (request.number != 5) return palpate::contact_on(request.line, 0.01 * request.number, 8.0, 1.0);
    return palpate::tap_without_contact(palpate::Outcome::aborted, 1.0, "the e-stop is pressed", true);
  }
  bool repeatable() const override { return false; }
  bool scene_is_truth() const override { return false; }
  palpate::QuantitySet reads() const override { return {palpate::quantity::kHeightMean}; }
  void show(const palpate::BeliefView& belief) override {
    shown_ += belief.values(palpate::quantity::kHeightMean).sum();
  }

 private:
  double shown_ = 0.0;
};

PALPATE_PLUGIN(palpate::Backend, Backend, PLUGIN_NAME, "cannot go on after its fifth tap")

}  // namespace broken
