// SPDX-License-Identifier: MIT
// Options of the fitting `ceres`.
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
                    "log-normal priors. Length scales have the median 1/12 of the area's longer side and the factor "
                    "1.5 per standard deviation. Signal: the largest deviation of a target from the mean, factor 1.35. "
                    "Noise: 0.3 of the signal (0.05 if the level of the surface is unknown), factor 1.5. Other kernel "
                    "parameters: 1, factor 2.7. A fitted mean has a normal prior around the mean of the targets; the "
                    "standard deviation is the largest deviation of a target",
                    {}},
                   {"none", "no priors. The fit needs more taps than hyperparameters", {}}});
    fields.choice(mean, Field("mean", "prior mean of the GP"),
                  {{"keep", "mean from the config", {}},
                   {"fit", "constant mean, fitted together with the other hyperparameters", {}}});
    fields.integer(every, Field("every", "number of taps from one fit to the next").within(1, 100000));
    fields.integer(starts, Field("starts",
                                 "number of optimisation starts. One start is at or near the present values. The other "
                                 "starts are random values within the range of the priors")
                               .within(1, 1000));
  }
};

}  // namespace palpate::fitting
