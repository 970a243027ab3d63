// SPDX-License-Identifier: MIT
// What a config says of a fit.
#pragma once

#include "objective.hpp"

#include <palpate/options.hpp>

#include <cstdint>

namespace palpate::fitting {

struct CeresOptions : Options {
  enum class Priors { touch, none };
  enum class Mean { keep, fit };

  Measure objective = Measure::log_marginal_likelihood;
  Priors priors = Priors::touch;
  Mean mean = Mean::keep;
  std::int64_t every = 1;
  std::int64_t starts = 3;

  void list(Fields& fields) override {
    fields.choice(objective, Field("objective", "what is maximised"),
                  {{"lml", "log marginal likelihood of the targets", {}},
                   {"loo", "log predictive density of each target, given the others", {}}});
    fields.choice(
        priors, Field("priors", "what is expected of the hyperparameters before any tap"),
        {{"touch",
          "log-normal densities: length scales 1/12 of the area's longer side, within a factor of 1.5; "
          "signal the largest deviation of a target from the mean, 1.35; noise 0.3 of the signal, or 0.05 where the "
          "level of the surface is open, 1.5; other kernel parameters 1, 2.7; a fitted mean within the largest "
          "deviation of the targets' own (a factor is one standard deviation of the logarithm)",
          {}},
         {"none", "nothing; needs more taps than hyperparameters", {}}});
    fields.choice(mean, Field("mean", "of the prior"),
                  {{"keep", "stays as the config says", {}}, {"fit", "one constant, fitted with the others", {}}});
    fields.integer(every, Field("every", "fit after each so many taps").at_least(1).at_most(100000));
    fields.integer(starts, Field("starts",
                                 "ascents: one from the present values or better ones near them, the others "
                                 "from random places within the expectations")
                               .at_least(1)
                               .at_most(1000));
  }
};

}  // namespace palpate::fitting
