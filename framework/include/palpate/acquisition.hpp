// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: scores of the candidates for the next tap.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// Laws, checked by the contract tests: the score is a pure function of the belief; the same belief gives the same
/// bytes, without clock or state. It is finite for every candidate. It reads exactly the quantities of reads().
class Acquisition {
 public:
  static constexpr const char* kKind = "acquisition";

  virtual ~Acquisition() = default;

  /// Returns the quantities that score() reads; constant over the object's lifetime. Only the models of these
  /// quantities are built. A belief that does not offer one of them is rejected before the first tap.
  virtual QuantitySet reads() const = 0;

  /// Scores all candidates at once; `out` has M elements. The candidate with the highest score is tapped next.
  virtual void score(const BeliefView& belief, VectorOut out) const = 0;

  /// Returns the size of a typical score before any tap, which is the unit of the tie tolerance if scores become small.
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
