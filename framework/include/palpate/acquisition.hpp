// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: scores of the candidates for the next tap.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// Laws, checked by the contract tests: the score is a pure function of the belief (same belief, same bytes; no clock,
/// no state), finite, and fills every candidate; it reads what reads() names, and all of that.
class Acquisition {
 public:
  static constexpr const char* kKind = "acquisition";

  virtual ~Acquisition() = default;

  /// Returns the quantities that score() reads, the same from birth to death. Their models are built, and no others. A
  /// belief that does not offer one is rejected before the first tap.
  virtual QuantitySet reads() const = 0;

  /// Scores all candidates at once; `out` has M elements. The candidate with the highest score is tapped next.
  virtual void score(const BeliefView& belief, VectorOut out) const = 0;

  /// Returns the size of a typical score before any tap: the unit in which ties are judged when scores become small.
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
