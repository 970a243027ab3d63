// SPDX-License-Identifier: MIT
// What is believed of the objects as a whole: some assemblies of simple solids, about equally likely, moved by Markov
// chain Monte Carlo after every touch. They say where a line that nobody has tried may meet something, and they are the
// mean that the process of residual_gp.hpp corrects.
#pragma once

#include "solids/primitive.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace palpate {

struct SolidsSettings {
  int count = 24;           ///< assemblies
  int moves = 1000;         ///< of each, after a touch; fewer after the 40th
  double misfit = 0.002;    ///< by how much a touch is off the simple solids, metres: they are but nearly the objects
  double primitives = 5.0;  ///< what one primitive more has to explain, nats
  double smallest = 0.002;  ///< half the least extent, metres
  double largest = 0.15;    ///< half the largest
  double most = std::numeric_limits<double>::infinity();  ///< nats that a touch costs at most: it may be a lie
};

/// Primitives, and what each touch so far is to each of them.
struct Assembly {
  struct Part {
    Primitive primitive;
    std::vector<double> reach;  ///< distance of the end of each touch
    std::vector<double> depth;  ///< how deep the free way of each touch passes through
    double prior = 0.0;         ///< log density
  };
  std::vector<Part> parts;
  double likelihood = 0.0;  ///< log
  double prior = 0.0;       ///< log

  double posterior() const { return likelihood + prior; }
  double first_intersection(const Line& line) const;
  double distance(const Eigen::Vector3d& point) const;
  /// Returns the gradient of the distance, of unit length.
  Eigen::Vector3d normal(const Eigen::Vector3d& point) const;
};

class Solids {
 public:
  Solids(const Area& area, const SolidsSettings& settings, Random random);

  /// Takes in touches made at once, one or few.
  void add(const std::vector<SurfaceTouch>& touches);
  /// The same touches as they are read now; of the settings `misfit` and `most` as they are from now on.
  void read_again(const std::vector<SurfaceTouch>& touches, double misfit, double most);
  /// Takes in a view before all touches: many at once, and as many rounds of moves as it would take to get there touch
  /// by touch, the first of them with the likelihood to a small power, from which it cools: so that no mode stays
  /// because it came first.
  void look(const std::vector<SurfaceTouch>& view);

  const std::vector<Assembly>& assemblies() const { return all_; }
  /// Of so many draws of one primitive more, attached to `one`, those that no touch so far contradicts: what nobody has
  /// seen. The share that is left is what the touches leave of its prior probability.
  std::vector<Primitive> undiscovered(const Assembly& one, int draws, Random& random) const;
  /// The one that is most probable.
  const Assembly& best() const;
  /// How far outside the surface of that one the surface of each lies near a point, metres, none more than 2 cm: a
  /// primitive that others do not have is somewhere else, or nowhere.
  Eigen::VectorXd offsets(const Eigen::Vector3d& at) const;

 private:
  double prior_of(const Primitive& primitive) const;
  void look(Assembly::Part& part, std::size_t from) const;
  /// The log likelihood of `one` with `primitive` (null: none) in the place of its part `which`, its number of parts
  /// for one more; -infinity as soon as it is sure to be below `least`. Leaves what each touch is to the primitive in
  /// scratch_.
  double likelihood_with(const Assembly& one, std::size_t which, const Primitive* primitive, double least);
  void resample(const std::vector<double>& weights);
  void take_in(const std::vector<SurfaceTouch>& touches);
  /// By what touches_ are from one of them on.
  void weigh(std::size_t from);
  void move_all();
  void move(Assembly& one);
  /// The least likelihood with which a change is taken, if it gains so much in prior: by Metropolis's rule, the
  /// likelihood to the power power_.
  double least_likelihood(const Assembly& one, double prior_gained);
  void give_birth(Assembly& one);
  void take_away(Assembly& one);
  bool change(Primitive& primitive);
  bool fit_to_contact(Primitive& primitive);

  SolidsSettings settings_;
  Random random_;
  std::vector<SurfaceTouch> touches_;
  std::size_t seen_ = 0;     ///< of them, in a view
  double last_power_ = 1.0;  ///< of the likelihood, at the end of a sweep of moves
  double power_ = 1.0;       ///< now
  std::vector<Assembly> all_;
  Assembly::Part scratch_;
  std::vector<std::size_t> order_;  ///< of the touches: those that refused a proposal last come first
};

}  // namespace palpate
