// SPDX-License-Identifier: MIT
// Decisions that all strategies share: where the first taps go, which scored candidate is chosen, and what happens if
// the scores do not distinguish candidates.
#pragma once

#include "experiment/experiment_options.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/random.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Returns the candidates of the first taps, all different, for a design with a fixed count. It depends only on the
/// design, the candidates and the seed, so strategies with equal seeds start alike. The config is rejected if there are
/// fewer candidates than taps.
std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed);

/// The outcome of a choice among scored candidates.
struct Pick {
  int candidate = -1;  ///< -1: none was allowed
  double score = 0.0;
  int ties = 0;        ///< candidates within the tie bound of the best, the chosen one included
  int runner_up = -1;  ///< the best of the others; -1 if there is no other
  double runner_up_score = 0.0;
  /// Set if the scores do not distinguish candidates: "every score is equal" or "no score is positive".
  std::optional<std::string> flat;
};

/// One flag per candidate: whether it may be tapped.
using Allowed = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Returns the highest score among the `allowed` candidates. Scores within tolerance x (|best| + scale) of the best are
/// tied; the lowest index wins. So rounding below that bound does not change the choice. All scores must be finite.
Pick pick_best(const Eigen::VectorXd& scores, const Allowed& allowed, double scale, double tolerance);

}  // namespace palpate
