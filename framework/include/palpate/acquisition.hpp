// SPDX-License-Identifier: MIT
// Plugin kind `acquisition`: how much one wants to tap each candidate next.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/surface_belief.hpp>
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

  /// Whether score() is of use, and whether score_approaches(), the same from birth to death: where the tool comes from
  /// above, or from any side.
  virtual bool from_above() const { return true; }
  virtual bool any_side() const { return false; }

  /// What score_approaches() reads of what only a SurfaceBelief has.
  virtual Quantities reads_of_approaches() const { return {}; }

  /// Scores all approaches at once, by the laws of score(); `out` has N elements. Views go by value, as in score().
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  virtual void score_approaches(const SurfaceBelief& /*belief*/, VectorOut /*out*/) const {}

  /// The size of a typical score before any tap: the unit in which ties are judged when scores become small.
  virtual double prior_scale() const = 0;
};

}  // namespace palpate
