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

/// Returns the candidates of the first taps, all different, for a design with a fixed count. The result depends only on
/// the design, the candidates and the seed, so strategies with equal seeds begin with the same taps. There must be at
/// least as many candidates as initial taps.
std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed);

/// The outcome of a choice among scored candidates.
struct Pick {
  int candidate = -1;  ///< -1 if no candidate was allowed
  double score = 0.0;
  int ties = 0;        ///< number of candidates tied with the best, including the chosen one
  int runner_up = -1;  ///< the best candidate except the chosen one; -1 if there is none
  double runner_up_score = 0.0;
  /// Set if the scores do not distinguish candidates: "every score is equal" or "no score is positive".
  std::optional<std::string> flat;
};

/// One flag per candidate: whether it may be tapped.
using Allowed = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Picks the best of the `allowed` candidates. Scores that are at most `tolerance` * (|best score| + `scale`) below the
/// best score are tied, and the lowest index among the tied candidates is chosen. So rounding errors below this bound
/// do not change the choice. All scores must be finite.
Pick pick_best(const Eigen::VectorXd& scores, const Allowed& allowed, double scale, double tolerance);

}  // namespace palpate
