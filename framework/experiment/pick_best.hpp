// SPDX-License-Identifier: MIT
// The choice among scored candidates, and whether the scores distinguish candidates.
#pragma once

#include <palpate/types.hpp>

#include <optional>
#include <string>

namespace palpate {

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
