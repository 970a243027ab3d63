// SPDX-License-Identifier: MIT
// Decisions that are no strategy's business: where the first taps go, which of the scored candidates is taken, and
// what happens when the scores say nothing.
#pragma once

#include "experiment/experiment_options.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/random.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The candidates of the first taps, all different, of a design that counts them. Depends on the design, the candidates
/// and the seed alone, so that strategies with equal seeds start alike. There are as many candidates: the field list of
/// the config refuses fewer.
std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed);

/// The outcome of a choice among scored candidates.
struct Pick {
  int candidate = -1;  ///< -1: none was allowed
  double score = 0.0;
  int ties = 0;        ///< candidates within the tie bound of the best, the chosen one included
  int runner_up = -1;  ///< the best of the others; -1 if there is no other
  double runner_up_score = 0.0;
  /// Set when the scores do not tell candidates apart: "every score is equal" or "no score is positive".
  std::optional<std::string> flat;
};

/// Of each candidate, whether it may be tapped.
using Allowed = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Takes the highest score among the candidates that are `allowed`. Scores within
/// tolerance x (|best| + scale) of the best are tied; the lowest index wins. So rounding decides nothing, as long as
/// it stays below that bound. All scores are finite.
Pick pick_best(const Eigen::VectorXd& scores, const Allowed& allowed, double scale, double tolerance);

}  // namespace palpate
