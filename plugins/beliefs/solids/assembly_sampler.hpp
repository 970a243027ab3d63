// SPDX-License-Identifier: MIT
// Belief about whole objects: some assemblies of simple solids, about equally probable, moved by Markov chain Monte
// Carlo after every touch. They predict where untried lines meet an object. The GP of residual_gp.hpp corrects the
// surface of the most probable one.
#pragma once

#include "solids/primitive.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <limits>
#include <vector>

namespace palpate {

struct AssemblySamplerSettings {
  int count = 24;           ///< number of assemblies
  int moves = 1000;         ///< number of moves per assembly and touch; fewer after the 40th touch
  double misfit = 0.002;    ///< standard deviation of touches from the simple solids, which approximate objects, metres
  double primitives = 5.0;  ///< log likelihood that an additional primitive has to gain, nats
  double smallest = 0.002;  ///< smallest half extent, metres
  double largest = 0.15;    ///< largest half extent, metres
  /// nats, largest loss of log likelihood by one touch, because a touch may be an outlier
  double most = std::numeric_limits<double>::infinity();
};

/// Primitives, and the distances of all touches to each of them.
struct Assembly {
  struct Part {
    Primitive primitive;
    std::vector<double> reach;  ///< distance from the end of each touch, metres
    std::vector<double> depth;  ///< penetration by the free part of each touch, metres
    double prior = 0.0;         ///< log density
  };
  std::vector<Part> parts;
  double likelihood = 0.0;  ///< log density
  double prior = 0.0;       ///< log density

  double posterior() const { return likelihood + prior; }
  double first_intersection(const Line& line) const;
  double distance(const Eigen::Vector3d& point) const;
  /// Returns the gradient of the distance, of unit length.
  Eigen::Vector3d normal(const Eigen::Vector3d& point) const;
};

class AssemblySampler {
 public:
  AssemblySampler(const Area& area, const AssemblySamplerSettings& settings, Random random);

  /// Adds touches that were made at the same time: one or a few.
  void add(const std::vector<SurfaceTouch>& touches);
  /// Replaces all touches by their current readings, and sets `misfit` and `most`.
  void read_again(const std::vector<SurfaceTouch>& touches, double misfit, double most);
  /// Adds a camera view before all touches: many touches at once, then several rounds of moves. The rounds begin with a
  /// flattened likelihood, a small power of it. The power then rises to 1 (simulated annealing), so that no mode
  /// survives only because it was found first.
  void look(const std::vector<SurfaceTouch>& view);

  const std::vector<Assembly>& assemblies() const { return all_; }
  /// Draws `draws` additional primitives, each attached to a primitive of `one`. Returns those that no touch
  /// contradicts: possible undiscovered objects. The share of returned draws estimates which part of the prior
  /// probability of such objects remains.
  std::vector<Primitive> undiscovered(const Assembly& one, int draws, Random& random) const;
  /// Returns the most probable assembly.
  const Assembly& best() const;
  /// Returns for each assembly how far its surface lies outside the surface of the best one near a point, metres.
  /// Values are clipped to 2 cm, because a primitive that other assemblies lack may be elsewhere or absent there.
  Eigen::VectorXd offsets(const Eigen::Vector3d& at) const;

 private:
  double prior_of(const Primitive& primitive) const;
  void look(Assembly::Part& part, std::size_t from) const;
  /// Returns the log likelihood of `one` with its part `which` replaced by `primitive` (null: removed). If `which` is
  /// the number of parts, `primitive` is added. Returns -infinity as soon as the value is certain to be below `least`.
  /// Leaves the distances of the touches to the primitive in scratch_.
  double likelihood_with(const Assembly& one, std::size_t which, const Primitive* primitive, double least);
  void resample(const std::vector<double>& weights);
  void take_in(const std::vector<SurfaceTouch>& touches);
  /// Weighs the assemblies by the touches_ from index `from` on, and resamples them.
  void weigh(std::size_t from);
  void move_all();
  void move(Assembly& one);
  /// Returns the smallest likelihood with which the Metropolis rule accepts a change that gains this log prior. The
  /// rule uses the likelihood to the power power_.
  double least_likelihood(const Assembly& one, double prior_gained);
  void give_birth(Assembly& one);
  void take_away(Assembly& one);
  bool change(Primitive& primitive);
  bool fit_to_contact(Primitive& primitive);

  AssemblySamplerSettings settings_;
  Random random_;
  std::vector<SurfaceTouch> touches_;
  std::size_t seen_ = 0;     ///< number of touches_ that come from a view
  double last_power_ = 1.0;  ///< power to which the likelihood is raised at the end of a sweep of moves
  double power_ = 1.0;       ///< current power
  std::vector<Assembly> all_;
  Assembly::Part scratch_;
  std::vector<std::size_t> order_;  ///< order of the touches; the last to reject a proposal is evaluated first
};

}  // namespace palpate
