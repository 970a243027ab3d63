// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: how much one wants to tap each candidate next.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// Laws, checked by the contract tests: the score is a pure function of the belief (same belief, same bytes; no clock,
/// no state), finite, and fills every candidate; it reads what reads() says, and all of that.
class Acquisition {
 public:
  static constexpr const char* kKind = "acquisition";

  virtual ~Acquisition() = default;

  /// What score() reads, the same from birth to death: the models of these are built, and no others.
  virtual Quantities reads() const = 0;

  /// Scores all candidates at once; `out` has M elements. The candidate of the highest score is tapped next.
  virtual void score(const Belief& belief, VectorOut out) const = 0;

  /// The size of a typical score before any tap: the unit in which ties are judged when scores become small.
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
