// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: scores of the candidates for the next tap.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

namespace palpate {

/// Laws, checked by the contract tests: scores are a pure function of the belief. The same belief gives the same bytes
/// at any time and after any earlier calls. Every score is finite. score() reads exactly the quantities that reads()
/// returns.
class Acquisition {
 public:
  static constexpr const char* kKind = "acquisition";

  virtual ~Acquisition() = default;

  /// Returns the quantities that score() reads; constant over the object's lifetime. Only the models of these
  /// quantities are built. A belief that does not offer one of them is rejected before the first tap.
  virtual QuantitySet reads() const = 0;

  /// Scores all M candidates at once; `out` has M elements. The candidate with the highest score is tapped next.
  virtual void score(const BeliefView& belief, VectorOut out) const = 0;

  /// Returns the size of a typical score before the first tap. Scores are tied if they differ by at most
  /// `tie_tolerance` times (|best score| + this size).
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
