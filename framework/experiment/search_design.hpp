// SPDX-License-Identifier: MIT
// The initial design `search`: finds an object whose position, shape and size are unknown, except for its smallest
// width.
#pragma once

#include "experiment/pick_best.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <vector>

namespace palpate {

/// A greedy search. It draws 16000 discs, each a hypothesis of the hidden object. The next tap is made where the discs
/// have the largest total weight. After each tap that finds no object, the search computes a probability for every
/// nearby disc: the probability that the tap would have missed an object with this outline. The weight of the disc is
/// multiplied by this probability. There are two causes of a miss: the tap lands outside the edge because of position
/// errors, or the arm does not detect the contact. So a tap with errors of millimetres does not rule out an object
/// whose edge is within these errors. Several positions may have the same weight, for example when no discs are left.
/// Then the position farthest from all taps and from the edge of the area is chosen.
///
/// Diameters lie between the smallest width and the area's shorter side, uniformly in their logarithm. With only the
/// smallest diameter, the search would scan the area in narrow rows and find large objects late. Large discs lead the
/// first taps to the middle of the area, which most large objects cover. Discs also suffice for boxes and rods. In
/// tests with 1000 random placements, hypotheses that were rectangles of all angles and proportions did not find these
/// objects sooner.
///
/// The next position depends only on the seed and the positions of the earlier taps. So runs whose taps missed at the
/// same positions choose the same next position.
class SearchDesign {
 public:
  /// `smallest`: metres, above 0 and below both sides of the area. `candidates` form a grid and outlive the search.
  SearchDesign(double smallest, const CandidateGrid& candidates, const Area& area, Random random);

  /// Adds the position of a tap, which the search treats as a position without an object. An unreachable position is
  /// added, too, so that the next tap is not at a neighbouring position that is probably unreachable as well. Discs
  /// that are not near the position keep their weights.
  void look(const Target& place);

  /// Returns the next candidate to tap, one of the `allowed` candidates. The first of equally good candidates is
  /// chosen. At least one candidate must be allowed.
  int next(const Allowed& allowed);

 private:
  struct Disc {
    double x, y, radius;
    int weight;  ///< probability that all taps so far would have missed this disc, in thousandths
  };

  /// Draws the discs at the first call of next(), so an unused search costs nothing.
  void draw_discs();
  void strike_off(const Target& place);
  /// Adds `weight` to the candidates in a disc.
  void weigh(const Disc& disc, int weight);
  /// Returns for each candidate the total weight of the discs that contain it.
  std::vector<int> weights() const;
  /// Returns the radius of the largest disc that is centred at `place`, lies in the area and contains no tap.
  double room(const Target& place) const;

  double smallest_;
  const CandidateGrid& candidates_;
  Area area_;
  Random random_;
  std::vector<Disc> discs_;  ///< discs with a positive weight
  /// per row of candidates: differences between neighbouring values of weights(); values outside the row count as 0
  std::vector<int> rises_;
  std::vector<Target> looked_;
  std::size_t struck_off_ = 0;  ///< number of positions in looked_ that are included in the weights of the discs
};

}  // namespace palpate
