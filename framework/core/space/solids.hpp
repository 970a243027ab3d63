// SPDX-License-Identifier: MIT
// What is believed of the objects as a whole: some compositions of simple solids, about equally likely, moved by Markov
// chain Monte Carlo after every touch. They say where a line that nobody has tried may meet something, and they are the
// mean that the process of implicit.hpp corrects.
#pragma once

#include "space/piece.hpp"
#include "space/surface_touch.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <cmath>
#include <optional>
#include <vector>

namespace palpate {

struct SolidsSettings {
  int count = 24;           ///< compositions
  int moves = 1000;         ///< of each, after a touch
  double misfit = 0.002;    ///< by how much a touch is off the simple solids, metres: they are but nearly the objects
  double pieces = 5.0;      ///< what one piece more has to explain, nats
  double smallest = 0.002;  ///< half the least extent, metres
  double largest = 0.15;    ///< half the largest
};

/// Pieces, and what each touch so far is to each of them.
struct Composition {
  struct Part {
    Piece piece;
    std::vector<double> reach;  ///< distance of the end of each touch
    std::vector<double> depth;  ///< how deep the free way of each touch passes through
    double prior = 0.0;         ///< log density
  };
  std::vector<Part> parts;
  double likelihood = 0.0;  ///< log
  double prior = 0.0;       ///< log

  double posterior() const { return likelihood + prior; }
  double first_hit(const Line& line) const;
  double distance(const Eigen::Vector3d& point) const;
};

class Solids {
 public:
  Solids(const Area& area, const SolidsSettings& settings, Random random);

  /// Takes in touches made at once, one or many.
  void add(const std::vector<SurfaceTouch>& touches);

  const std::vector<Composition>& compositions() const { return all_; }
  /// A piece that nobody touched, attached to a composition, which no touch so far contradicts; none where a few draws
  /// from the prior find none.
  std::optional<Piece> unseen(const Composition& one, Random& random) const;
  /// The one that is most probable.
  const Composition& best() const;

 private:
  double prior_of(const Piece& piece) const;
  void look(Composition::Part& part, std::size_t from) const;
  /// The log likelihood of `one` with `piece` (null: none) in the place of its part `which`, its number of parts for
  /// one more; -infinity as soon as it is sure to be below `least`. Leaves what each touch is to the piece in scratch_.
  double likelihood_with(const Composition& one, std::size_t which, const Piece* piece, double least);
  void resample(const std::vector<double>& weights);
  void move(Composition& one);
  bool give_birth(Composition& one);
  bool take_away(Composition& one);
  bool change(Piece& piece);
  bool fit_to_contact(Piece& piece);

  Area area_;
  SolidsSettings settings_;
  Random random_;
  std::vector<SurfaceTouch> touches_;
  std::vector<Composition> all_;
  Composition::Part scratch_;
  std::vector<std::size_t> order_;  ///< of the touches: those that refused a proposal last come first
};

}  // namespace palpate
