// SPDX-License-Identifier: MIT
// Undiscovered primitives: primitives without an object tap inside.
//
// The prior is a Poisson process, so primitives are independent. Hypotheses contain the primitives with an object tap.
// The others form another Poisson process: none has an object tap inside, and each desk tap reduces the probability of
// primitives around it (thinning: Kingman 1993). So the probability that a tap finds a new object does not depend on
// the hypotheses.
#pragma once

#include "coverage.hpp"

#include <palpate/random.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace palpate::footprints {

/// Process of undiscovered primitives, represented by weighted draws from the prior.
class UndiscoveredPrimitives {
 public:
  UndiscoveredPrimitives(const Prior& prior, Random& random);

  /// Draws that contain a position.
  class CoveringDraws {
   public:
    /// Returns the expected number of undiscovered primitives at the position.
    double rate() const { return rate_; }
    /// Returns a random primitive at the position. The rate must be above 0.
    const Primitive& draw(Random& random) const;

   private:
    friend class UndiscoveredPrimitives;
    std::vector<const Primitive*> primitives_;
    std::vector<std::uint64_t> cumulative_;  ///< cumulative weights
    double rate_ = 0.0;
  };
  /// Returns the draws at `position`, valid until the next tap.
  CoveringDraws covering(const Target& position) const;

  /// Updates the weights with a tap at its original position. Each draw is weighted as if no other primitive could
  /// explain the label. If a known primitive also contains the desk tap, the weights become too small. This error
  /// changes the probability of an object by at most 0.01. The change is at most 0.1 if the contacts with the known
  /// primitive are all near its rim, within the noise.
  ///
  /// One process serves exact and noisy hypotheses. With position noise, `labels` is the label model of the noisy
  /// hypotheses. The expected number of primitives is then 0.012 smaller on average (at most 0.026 in 40 scenes of 40
  /// taps). The odds of noisy against exact positions should include the factor exp(this difference), but omit it.
  void add(const Touch& touch, const LabelModel& labels);

  /// Prepares grid(), rates() and expected_extent() for positions, M x 2 metres. Returns whether they differ from the
  /// positions of the last call.
  bool prepare(const PointsView& positions);
  /// Returns the prepared positions.
  const CoverageGrid& grid() const { return *grid_; }
  /// Returns the rate at each of the prepared positions.
  Eigen::VectorXd rates() const { return rates_.values(unit_); }
  /// Returns for each prepared position the expected total area, in square metres, of the undiscovered primitives that
  /// cover it and are apart from known primitives. The area of a hole counts. The sum uses every second draw.
  Eigen::VectorXd expected_extent() const;

  /// A draw is apart from a hypothesis if it overlaps none of the hypothesis's primitives. For each draw, counts the
  /// hypotheses in `known` from which the draw is apart. `known` must not be empty. The counts are valid until the next
  /// tap. Eight hypotheses give the probability in steps of 1/8.
  void compare(const std::vector<const Hypothesis*>& known);
  /// Returns the expected number of primitives of at least `length` metres that are apart from known hypotheses.
  double expected_apart(double length) const;
  /// Calls visit(primitive, expected number) for each draw, for tests against the exact process.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Draw& one : draws_) visit(one.primitive, unit_ * one.weight);
  }

  /// A primitive in one of several sets of undiscovered primitives.
  struct Member {
    int set;
    const Primitive* primitive;
  };
  /// Draws `count` sets; returns their members ordered by set.
  std::vector<Member> draw(int count, Random& random) const;

 private:
  // Integer weights, whose sums have the same bytes in any order.
  using Weight = std::uint32_t;
  static constexpr Weight kWhole = 1U << 20U;

  struct Draw {
    Primitive primitive;
    Weight weight;
    CoverageGrid::Spans spans;
  };
  void change(Draw& draw, Weight to);
  /// Removes draws of weight 0, which cannot recover, and prepares the others for compare().
  void update();
  /// Calls visit(draw) for all draws within `reach` of a position, and for some others.
  template <class Draws, class Visit>
  void for_each_near(Draws& draws, const Target& position, double reach, const Visit& visit) const;
  std::int64_t apart(std::size_t draw) const { return known_ - static_cast<std::int64_t>(overlaps_[draw]); }

  std::vector<Draw> draws_;
  FormTable forms_;              ///< forms of the draws
  std::vector<float> overlaps_;  ///< number of known hypotheses that each draw overlaps
  std::int64_t known_ = 1;       ///< number of these hypotheses
  double unit_;                  ///< expected number of primitives per unit of weight
  std::optional<CoverageGrid> grid_;
  GridSums rates_{0};  ///< weights
};

}  // namespace palpate::footprints
