// SPDX-License-Identifier: MIT
// A belief over outlines as a set of equally likely outlines, moved by Markov chain Monte Carlo after every touch
// (resample-move: Gilks and Berzuini 2001; moves between one and two pieces: Green 1995).
#pragma once

#include "outline.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <vector>

namespace palpate::footprints {

struct ParticleSettings {
  int count = 2000;
  double mistaken = 0.01;  ///< probability that a label is wrong
  /// Moves of each outline after a touch, over the share of outlines that its label leaves (the effective sample size:
  /// Kong, Liu and Wong 1994): a label that nobody expected leaves many copies of few outlines, which have to part.
  double moves = 4.0;
  int most_moves = 40;
};

/// An outline, and what its moves ask for again and again.
struct Particle {
  Outline outline;
  double density;    ///< by the prior, up to a constant factor
  int mistakes = 0;  ///< touches so far that it has wrong
};

class Particles {
 public:
  /// Draws the outlines from the prior. Throws Error where the area has no room for the smallest.
  Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random);

  /// Weighs all outlines by a label, draws as many of them by their weights, and moves each. Returns the probability
  /// that this label had before.
  double add(const Touch& touch);

  /// Sets `inside` (M) to how many outlines hold each of the places: quickly if those are a lattice, row by row.
  void count_inside(const PointsView& places, VectorOut inside) const;

  /// Touches so far that an outline has wrong, on average.
  double mean_mistakes() const;
  /// Share of the outlines that are one piece.
  double share_of_one() const;
  /// Share of moves that were taken, of all so far.
  double acceptance() const { return tried_ > 0 ? static_cast<double>(moved_) / static_cast<double>(tried_) : 0.0; }

  int size() const { return static_cast<int>(particles_.size()); }
  const std::vector<Particle>& particles() const { return particles_; }

 private:
  void resample(const std::vector<double>& weights, double sum);
  void move(Particle& particle);

  OutlinePrior prior_;
  ParticleSettings settings_;
  Random random_;
  std::vector<Particle> particles_;
  std::vector<Touch> touches_;
  double log_odds_;  ///< of a right label against a wrong one
  long tried_ = 0;
  long moved_ = 0;
};

}  // namespace palpate::footprints
