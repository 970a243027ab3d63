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

  void list(Fields& fields) override;
};

}  // namespace palpate::fitting
