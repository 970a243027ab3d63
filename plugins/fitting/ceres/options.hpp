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
    fields.choice(objective, Field("objective", "objective that the fit maximises"),
                  {{"lml", "log marginal likelihood of the targets", {}},
                   {"loo", "leave-one-out log predictive density of the targets", {}}});
    fields.choice(priors, Field("priors", "prior densities of the hyperparameters"),
                  {{"touch",
                    "log-normal, with median and factor of one standard deviation: length scales 1/12 of the area's "
                    "longer side, 1.5; signal the largest deviation of a target from the mean, 1.35; noise 0.3 of the "
                    "signal, or 0.05 if the level of the surface is unknown, 1.5; other kernel parameters 1, 2.7; a "
                    "fitted mean is normal around the mean of the targets, within their largest deviation",
                    {}},
                   {"none", "no priors; the fit needs more taps than hyperparameters", {}}});
    fields.choice(mean, Field("mean", "prior mean of the GP"),
                  {{"keep", "mean that the config gives", {}},
                   {"fit", "constant mean, fitted together with the other hyperparameters", {}}});
    fields.integer(every, Field("every", "number of taps from one fit to the next").at_least(1).at_most(100000));
    fields.integer(starts, Field("starts",
                                 "number of ascents: one starts at or near the present values, the others at random "
                                 "values within the range of the priors")
                               .at_least(1)
                               .at_most(1000));
  }
};

}  // namespace palpate::fitting
