// SPDX-License-Identifier: MIT
// Keeps the hyperparameters of the config, as Sun and Min 2021 do.
#include <palpate/fitting.hpp>
#include <palpate/plugin.hpp>

namespace palpate::fitting {

class FixedFitting final : public Fitting {
 public:
  using Options = NoOptions;
  FixedFitting(const Options&, const Context&) {}

  bool due(int) const override { return false; }
  FitSummary fit(FitProblem&, Random&) const override { return {false, false, 0.0, 0, "hyperparameters are fixed"}; }
};

PALPATE_PLUGIN(Fitting, FixedFitting, "fixed", "fixed hyperparameters from the config, as in the paper")

}  // namespace palpate::fitting
