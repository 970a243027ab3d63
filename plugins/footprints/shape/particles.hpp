// SPDX-License-Identifier: MIT
// A belief over outlines as a set of equally likely outlines, moved by Markov chain Monte Carlo after every touch
// (resample-move: Gilks and Berzuini 2001).
#pragma once

#include "outline.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <vector>

namespace palpate::footprints {

/// What is thought of an outline before any touch: a single object that lies wholly on the area, its centre and angle
/// uniform, the logarithms of its half axes uniform and independent, the longer at most `most_slender` times the other.
struct OutlinePrior {
  Area area;
  double smallest = 0.02;     ///< least width, metres
  double largest = 0.22;      ///< greatest length, metres
  double most_slender = 8.0;  ///< ratio of length to width
  double ellipses = 0.3;      ///< probability that it is an ellipse
};

struct ParticleSettings {
  int count = 2000;
  int sweeps = 3;          ///< moves of each outline after a touch
  double mistaken = 0.02;  ///< probability that a label is wrong
};

class Particles {
 public:
  /// Draws the outlines from the prior. Throws Error where the area has no room for the smallest.
  Particles(const OutlinePrior& prior, const ParticleSettings& settings, Random random);

  /// Weighs all outlines by a label, draws as many of them by their weights, and moves each. Returns the probability
  /// that this label had before.
  double add(const Target& place, bool on);

  /// Adds to `inside` (M) how many outlines hold each of the places, a lattice of `columns` columns row by row.
  void count_inside(const PointsView& places, int columns, VectorOut inside) const;

  /// Touches so far that an outline has wrong, on average.
  double mean_mistakes() const;

  int size() const { return static_cast<int>(outlines_.size()); }
  const std::vector<Outline>& outlines() const { return outlines_; }
  /// Share of moves that were taken, of all so far.
  double acceptance() const { return tried_ > 0 ? static_cast<double>(moved_) / static_cast<double>(tried_) : 0.0; }

 private:
  struct Label {
    Target place;
    bool on;
  };

  Outline draw();
  bool possible(const Outline& outline) const;
  int mistakes(const Region& region) const;
  void resample(const std::vector<double>& weights);
  void move(std::size_t which);
  /// A changed outline, and the factor by which the proposal prefers it over the way back; 0 for none.
  double propose(Outline& outline);

  OutlinePrior prior_;
  ParticleSettings settings_;
  Random random_;
  std::vector<Outline> outlines_;
  std::vector<Label> labels_;
  double log_odds_;  ///< of a right label against a wrong one
  long tried_ = 0;
  long moved_ = 0;
};

}  // namespace palpate::footprints
