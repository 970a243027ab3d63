// SPDX-License-Identifier: MIT
// Primitives without an object tap inside.
//
// The prior is a Poisson process, so primitives are independent of each other. The hypotheses consist of the primitives
// with an object tap inside. All others are a Poisson process again: none has an object tap inside, and each tap of the
// desk makes a primitive about the tap less probable (thinning: Kingman 1993). So the probability that a tap finds a
// new object needs no hypothesis.
#pragma once

#include "coverage.hpp"

#include <palpate/random.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace palpate::footprints {

/// The process of undiscovered primitives, as draws of the prior with weights.
class Undiscovered {
 public:
  Undiscovered(const Prior& prior, Random& random);

  /// The draws that contain a position.
  class Covering {
   public:
    /// The expected number of undiscovered primitives there.
    double rate() const { return rate_; }
    /// Draws one of them. The rate must be above 0.
    const Primitive& draw(Random& random) const;

   private:
    friend class Undiscovered;
    std::vector<const Primitive*> primitives_;
    std::vector<std::uint64_t> cumulative_;  ///< weights
    double rate_ = 0.0;
  };
  /// Valid until the next tap.
  Covering covering(const Target& position) const;

  /// Updates the weights by a tap, where it was made. Each draw is weighed as if no other primitive could explain the
  /// label. If a known primitive contains a tap of the desk as well, the weights become too small: probabilities change
  /// by 0.01 or less, and by 0.1 if a noisy rim is all that is known.
  ///
  /// One process serves exact and noisy hypotheses. With position noise, `labels` is that of noisy ones; the expected
  /// number of primitives then is 0.012 smaller on average (0.026 at most in 40 scenes of 40 taps). The odds of noisy
  /// against exact positions should have the factor exp(this difference), and omit it.
  void add(const Touch& touch, const LabelModel& labels);

  /// Prepares grid(), rates() and expected_extent() for positions, M x 2 metres. Returns whether they differ from those
  /// of the last call.
  bool prepare(const PointsView& positions);
  /// The prepared positions.
  const Grid& grid() const { return *grid_; }
  /// Returns the rate at each of the prepared positions.
  Eigen::VectorXd rates() const { return rates_.values(unit_); }
  /// Returns for each of them the expected extent of all forms, holes included, that are apart from what is known and
  /// cover the position, square metres, as a sum over every second draw.
  Eigen::VectorXd expected_extent() const;

  /// Compares the draws with hypotheses, at least one, until the next tap. A draw is apart from a hypothesis if it
  /// overlaps none of its primitives. Eight hypotheses give the probability to be apart in steps of 1/8.
  void compare(const std::vector<const Hypothesis*>& known);
  /// Returns the expected number of primitives at least `length` long, metres, that are apart.
  double expected_apart(double length) const;
  /// Calls visit(primitive, expected number) for each draw: what tests compare with the exact process.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Draw& one : draws_) visit(one.primitive, unit_ * one.weight);
  }

  /// A primitive in one of many sets of undiscovered primitives.
  struct Member {
    int set;
    const Primitive* primitive;
  };
  /// Draws `count` sets; returns their members, set by set.
  std::vector<Member> draw(int count, Random& random) const;

 private:
  // Whole numbers: their sums have the same bytes in any order.
  using Weight = std::uint32_t;
  static constexpr Weight kWhole = 1U << 20U;

  struct Draw {
    Primitive primitive;
    Weight weight;
    Grid::Spans spans;
  };
  void change(Draw& draw, Weight to);
  /// Erases draws of weight 0, which never return, and prepares the others for compare().
  void update();
  /// Calls visit(draw) for all draws within `reach` of a position, and for some more.
  template <class Draws, class Visit>
  void for_each_near(Draws& draws, const Target& position, double reach, const Visit& visit) const;
  std::int64_t apart(std::size_t draw) const { return known_ - static_cast<std::int64_t>(overlaps_[draw]); }

  std::vector<Draw> draws_;
  FormTable forms_;              ///< of the draws
  std::vector<float> overlaps_;  ///< number of known hypotheses that each draw overlaps
  std::int64_t known_ = 1;       ///< number of these hypotheses
  double unit_;                  ///< expected number of primitives per unit of weight
  std::optional<Grid> grid_;
  GridSums rates_{0};  ///< weights
};

}  // namespace palpate::footprints
