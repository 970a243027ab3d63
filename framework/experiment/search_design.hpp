// SPDX-License-Identifier: MIT
// The initial design `search`: finds an object of which only the smallest size is known.
#pragma once

#include "experiment/policy.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <vector>

namespace palpate {

/// A greedy search. It draws 16000 discs, each a hypothesis of the hidden object. The next tap goes where the discs
/// have the largest total weight. After each tap that finds nothing, the weight of every disc near it is multiplied by
/// the probability that the tap missed such an object. The tap may have landed outside the edge, or the arm may have
/// felt nothing. So a tap of an arm with errors of millimetres does not rule out objects that it missed narrowly. If
/// positions have equal weight, for example without discs, the tap goes to the middle of the largest gap, farthest from
/// all taps and from the edge of the area.
///
/// Diameters lie between the smallest object and the area's shorter side, uniformly in their logarithm. With only the
/// smallest, the search would scan the area in narrow rows and find large objects late. Large discs send the first taps
/// to the middle, which most large objects cover. Discs also suffice for boxes and rods: rectangles of all angles and
/// proportions find none of them sooner, up to the noise of 1000 placements.
///
/// Whoever misses in the same places is sent to the same next one: its state is the seed and the places looked at.
class SearchDesign {
 public:
  /// `smallest`: metres, above 0 and below both sides of the area. `candidates` form a grid and outlive the search.
  SearchDesign(double smallest, const CandidateGrid& candidates, const Area& area, Random random);

  /// Adds a tap without a contact on an object. An unreachable position counts, too: then the arm does not try its
  /// neighbours at once, and the discs beside it stay.
  void look(const Target& place);

  /// Returns the next candidate to tap, one of the `allowed`; the first of equally good ones. At least one must be
  /// allowed.
  int next(const Allowed& allowed);

 private:
  struct Disc {
    double x, y, radius;
    int weight;  ///< probability that all taps so far missed it, in thousandths
  };

  /// Draws the discs at the first call of next(), so an unused search costs nothing.
  void draw_discs();
  void strike_off(const Target& place);
  /// Adds `weight` to the candidates in a disc.
  void weigh(const Disc& disc, int weight);
  /// Returns the total weight of the discs that contain each candidate.
  std::vector<int> weights() const;
  /// Returns the radius of the largest disc around a position that lies in the area and contains no tap.
  double room(const Target& place) const;

  double smallest_;
  const CandidateGrid& candidates_;
  Area area_;
  Random random_;
  std::vector<Disc> discs_;  ///< discs with a positive weight
  std::vector<int> rises_;   ///< differences of weights() along each row, with 0 before and after the row
  std::vector<Target> looked_;
  std::size_t struck_off_ = 0;  ///< number of looked_ already applied to the discs; applied only by next()
};

}  // namespace palpate
