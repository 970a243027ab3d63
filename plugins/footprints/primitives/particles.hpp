// SPDX-License-Identifier: MIT
// A belief over outlines as a set of equally likely outlines, moved by Markov chain Monte Carlo after every touch
// (resample-move: Gilks and Berzuini 2001).
#pragma once

#include "labels.hpp"
#include "lattice.hpp"
#include "particle.hpp"
#include "proposals.hpp"
#include "unseen.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <optional>
#include <vector>

namespace palpate::footprints {

struct ParticleSettings {
  /// Outlines; twice as many for ten touches from when something was found.
  int count = 384;
  double mistaken = 0.01;  ///< probability that a touch of an object has the label of the desk
  double lies = 0.01;      ///< probability that a touch of the desk has the label of an object
  /// Standard deviation of the place of a touch, along x and y, metres, if there is any: half of the outlines believe
  /// so at first, and half that places are exact.
  double blur = 0.0;
  /// Probability, between two touches, that the objects are pushed; an outline has been so once at most.
  double pushes = 0.0;
  bool heights = true;  ///< whether heights tell pieces apart
  /// Moves after a touch, of each piece and each hole of an outline, and so many more over the odds that an outline is
  /// left by its label (of the effective sample size: Kong, Liu and Wong 1994): a label that nobody expected leaves
  /// many copies of few outlines, which have to part. What the touch tells nothing of counts for three at most.
  double moves = 2.5;
  double moves_apart = 7.5;
  int most_moves = 200;
};

/// Weighing, drawing again and moving: particles.cpp. What is asked of the outlines: particles_asked.cpp.
class Particles {
 public:
  /// Draws the outlines from the prior.
  Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random);

  /// Weighs all outlines by a touch, draws some of them by their weights, and moves each. Returns the probability
  /// that its label had before.
  double add(const Touch& touch);

  /// The probability that each of the places is on an object.
  void probability(const PointsView& places, VectorOut out);

  /// `count` of the outlines, a multiple of 64, over the places, each with what may be there beside: whole words of 64
  /// outlines, of which there must be one, evenly among all.
  void sample(const PointsView& places, int count, OutlineSample& out) const;

  /// The probability that the label of each touch so far is wrong, and no blur accounts for it.
  void doubt(VectorOut out) const;

  /// Where each touch so far would be made now (rows as they were made; set already to where they were): elsewhere
  /// where more than half of the outlines were pushed since.
  void current_positions(Points& places) const;
  /// Share of the outlines that were pushed, and the touches before it and the shift of an average one of these.
  struct Pushed {
    double share = 0.0;
    double before = 0.0;
    double shift = 0.0;  ///< of the first piece, metres
  };
  Pushed pushed() const;

  /// The probability that there is something at least `size` long (metres) that was not touched: a piece that lies
  /// apart from all that hold a touch of an object.
  double undiscovered_probability(double size) const;

  /// Touches so far that an outline has wrong, on average.
  double mean_mistakes() const;
  /// Pieces of an outline, on average.
  double mean_pieces() const;
  /// Share of moves that were taken, of all so far.
  double acceptance() const { return tried_ > 0 ? static_cast<double>(moved_) / static_cast<double>(tried_) : 0.0; }

  int size() const { return static_cast<int>(particles_.size()); }
  const std::vector<Particle>& particles() const { return particles_; }

 private:
  /// What each outline holds of a lattice.
  LatticeBits held(const Lattice& lattice) const;
  /// How many outlines there are to be now.
  std::size_t count() const;
  void resample(const std::vector<double>& weights, double sum, std::size_t count);
  /// By all touches, from its depths.
  void weigh_again(Particle& particle);
  void find(std::size_t number, const Unseen::Holding& unseen, double something_new);
  void move(Particle& particle);
  int moves(double left) const;
  bool weigh(Particle& particle, const Proposal& proposal, bool blurred);
  /// How deep the latest touch lies in its pieces.
  void look(Particle& particle) const;
  /// What the heights say for so many pieces with these rows of depths.
  double evidence(const LabelModel::Step* const* rows, int pieces);
  /// The touches as seen after a push.
  const Places& seen_after(const Push& push) { return push ? carried_by(push) : places_; }
  const Places& carried_by(const Push& push);
  /// Whether each piece holds a touch of an object.
  bool all_touched(const LabelModel::Step* const* rows, int pieces) const;
  const LabelModel& labels(bool blurred) const { return blurred ? blurred_ : exact_; }

  OutlinePrior prior_;
  ParticleSettings settings_;
  Random random_;
  std::vector<Particle> particles_;
  std::vector<Touch> touches_;
  LabelModel exact_, blurred_;
  HeightModel heights_;
  Unseen unseen_;
  std::optional<LatticeBits> held_;  ///< by each outline, of the lattice asked about since the latest touch
  std::size_t new_until_ = 0;        ///< so many touches are made, what was found last is new
  long tried_ = 0;
  long moved_ = 0;

  Places places_;                          ///< of the touches, as made
  std::vector<LabelModel::Step> objects_;  ///< of each touch: all bits where it is of an object, or none
  int of_objects_ = 0;

  // What moves work with, kept so that it need not be made for each of them.
  Proposal proposal_;
  Depths depths_;
  Places pushed_places_;  ///< by the push that follows
  Push pushed_by_;
  std::vector<std::uint16_t> holders_;
};

}  // namespace palpate::footprints
