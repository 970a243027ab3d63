// SPDX-License-Identifier: MIT
// Where to look for an object of which nothing is known but how small it may be: the initial design `search`.
#pragma once

#include "experiment/policy.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <vector>

namespace palpate {

/// A greedy search. Some thousand discs, each a place where the object could be hidden, are drawn; the next tap goes
/// where most of them are, and those that hold it drop out, but for how probable it is that the tap missed the object
/// beside its edge, or did not feel it: an arm that is off by millimetres may not strike off what it passed by. Of
/// places that as much speaks for, as of all once no disc is left, it takes the middle of the largest gap: the one
/// farthest from all taps and from the edge of the area.
///
/// Diameters run from the smallest object to the area's shorter side, uniformly in their logarithms: of the smallest
/// alone, the search would comb the area in narrow rows and meet a large object late; the large discs send the first
/// taps to the middle, where there is most of every object that must fit into the area. Discs do for boxes and rods:
/// outlines of all angles and proportions find none of them sooner by more than the noise of 1000 placements.
///
/// Whoever misses in the same places is sent to the same next one: its state is the seed and the places looked at.
class SearchDesign {
 public:
  /// `smallest`: metres, above 0 and below both sides of the area. `candidates` form a grid and outlive the search.
  SearchDesign(double smallest, const CandidateGrid& candidates, const Area& area, Random random);

  /// There was a tap that hit nothing. A place that cannot be reached counts, too: the arm need not try the neighbours
  /// at once, and the discs beside it stay.
  void look(const Target& place);

  /// The candidate to tap next, one of the `allowed`; of equals the first. At least one must be allowed.
  int next(const Allowed& allowed);

 private:
  struct Disc {
    double x, y, radius;
    int weight;  ///< probability that it was passed by as often as was looked there, in thousandths
  };

  /// When the first place is asked for: of a search that nobody asks only its options count.
  void draw_discs();
  void strike_off(const Target& place);
  /// Adds to what the candidates in a disc weigh.
  void weigh(const Disc& disc, int weight);
  /// What the discs that hold each candidate weigh.
  std::vector<int> weights() const;
  /// Radius of the largest disc around a place that lies on the area and has no tap in it.
  double room(const Target& place) const;

  double smallest_;
  const CandidateGrid& candidates_;
  Area area_;
  Random random_;
  std::vector<Disc> discs_;  ///< those of some weight
  std::vector<int> rises_;   ///< of weights(), from one candidate of a row to the next; first and last of a row apart
  std::vector<Target> looked_;
  std::size_t struck_off_ = 0;  ///< of these: only when the next place is asked for, after a hit nobody asks
};

}  // namespace palpate
