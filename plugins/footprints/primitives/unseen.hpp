// SPDX-License-Identifier: MIT
// What nobody has touched yet: the pieces that may still be somewhere.
//
// Pieces are a Poisson process: so many are expected, and they know nothing of each other. Those that hold a touch of
// an object are known, and the outlines of the belief are made of them. All others are a Poisson process once more,
// less dense where touches of the desk speak against a piece, and none that would hold a touch of an object (thinning:
// Kingman 1993). So nothing has to be drawn to know how probable it is that a tap finds something new.
#pragma once

#include "forms.hpp"
#include "labels.hpp"
#include "lattice.hpp"
#include "outline.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace palpate::footprints {

class Unseen {
 public:
  /// Draws pieces from the prior, which stand for all that may be there.
  Unseen(const OutlinePrior& prior, Random& random);

  /// Those pieces that hold a place.
  class Holding {
   public:
    /// How many of them are expected to be there; without touches far apart all over the area about the same.
    double rate() const { return rate_; }
    /// One of them, as probable as each is. The rate must be above 0.
    const Piece& draw(Random& random) const;

   private:
    friend class Unseen;
    static std::size_t draw(const std::vector<std::uint64_t>& reached, Random& random);
    std::vector<const Piece*> pieces_;
    std::vector<std::uint64_t> reached_;  ///< sums of the weights up to each
    double rate_ = 0.0;
  };
  Holding holding(const Target& place) const;

  /// There was a touch: of the desk, and `labels` say what that tells of a piece, or of an object.
  void add(const Touch& touch, const LabelModel& labels);

  /// The rates at the places, M x 2 metres, and the lattice that they are, if any. Quick where it is the same as
  /// before.
  void rates(const PointsView& places, const std::optional<Lattice>& lattice, VectorOut out);

  /// Tells some of the outlines that what is known may have: what meets none of its pieces lies apart.
  void lie_apart_from(const std::vector<const Outline*>& known);
  /// Calls visit(piece, expected, apart) for those that may be there: how often each is expected, and which share of
  /// the outlines it lies apart from.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (weights_[i] > 0) visit(pieces_[i], expected(i), static_cast<double>(apart_[i]));
    }
  }
  /// How many pieces at least `size` long, metres, are expected that lie apart.
  double apart(double size) const;
  /// The extent of what lies apart and holds a place, as expected at each of them, square metres.
  void to_find(const PointsView& places, const std::optional<Lattice>& lattice, VectorOut out) const;

  /// A piece, by its number, that is there in one of many draws.
  struct Drawn {
    std::size_t draw;
    std::size_t piece;
  };
  /// What is there in each of so many draws, one after another.
  std::vector<Drawn> draw(std::size_t count, Random& random) const;
  const Piece& piece(std::size_t one) const { return pieces_[one]; }
  /// What each of them holds of a lattice, where it is the one that rates() was asked about last; or none.
  const LatticeRuns* runs(const Lattice& lattice) const {
    return runs_ && runs_->lattice() == lattice ? &*runs_ : nullptr;
  }

 private:
  // Whole numbers, of which sums are exact whatever their order: a run that goes on sums up otherwise.
  using Weight = std::uint32_t;
  static constexpr Weight kWhole = 1U << 20U;

  double expected(std::size_t one) const { return unit_ * weights_[one]; }
  void change(std::size_t one, Weight to);
  /// Calls visit(one) for those that are there and no farther than `reach` from a place, and for some more.
  template <class Visit>
  void for_each_near(const Target& place, double reach, const Visit& visit) const;

  std::vector<Piece> pieces_;
  std::vector<Weight> weights_;
  std::vector<float> apart_;        ///< share of the outlines of what is known that each lies apart from
  std::vector<std::size_t> there_;  ///< most of those that are there, or may have been lately
  Forms forms_;                     ///< theirs
  Eigen::ArrayXf xs_, ys_, radii_;  ///< of their forms, to see quickly which are near: none that are gone
  double unit_;                     ///< what one in kWhole of a piece is expected to be there as often as
  std::optional<LatticeCounts> counts_;
  std::optional<LatticeRuns> runs_;   ///< of all pieces there
  std::vector<Weight> counted_;       ///< what each piece counts for there
  std::vector<std::size_t> changed_;  ///< since then
};

}  // namespace palpate::footprints
