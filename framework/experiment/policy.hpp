// SPDX-License-Identifier: MIT
// Decisions that are no strategy's business: where the first taps go, which of the scored candidates is taken, and
// what happens when the scores say nothing.
#pragma once

#include "experiment/experiment_options.hpp"
#include "gp/candidates.hpp"
#include "gp/scores.hpp"

#include <palpate/random.hpp>
#include <palpate/types.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The candidates of the first taps, all different, of a design that counts them. Depends on the design, the candidates
/// and the seed alone, so that strategies with equal seeds start alike. Throws Error when there are fewer candidates
/// than taps.
std::vector<int> initial_design(const InitialOptions& options, const Candidates& candidates, const Area& area,
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

/// Takes the highest score among the candidates that are `allowed`. Scores within
/// tolerance x (|best| + scale) of the best are tied; the lowest index wins. So rounding decides nothing, as long as
/// it stays below that bound. Reads only the pieces of the scores that may matter, and keeps its memory for the next
/// choice. Throws Error when it meets a score that is not finite.
class Picker {
 public:
  Pick pick(const Scores& scores, const std::vector<bool>& allowed, double scale, double tolerance);

 private:
  using Cell = ScoredCell;
  /// The best two of the allowed candidates; of equals, the first.
  void find_two();
  /// The first of all that are not below `threshold`.
  void choose_first(double threshold, Pick& out);
  bool any_below(double threshold);
  /// Visits the allowed candidates of a piece whose score is not below `least`.
  template <class Visit>
  void for_allowed(int piece, double least, const Visit& visit);
  static bool before(const Cell& a, const Cell& b);

  const Scores* scores_ = nullptr;
  const std::vector<bool>* allowed_ = nullptr;
  std::vector<double> bounds_;
  std::array<Cell, kMostCells> cells_;
  Cell best_{};
  Cell second_{};
};

}  // namespace palpate
