// SPDX-License-Identifier: MIT
// A belief over outlines as a set of equally likely outlines, moved by Markov chain Monte Carlo after every touch
// (resample-move: Gilks and Berzuini 2001; moves between one and two pieces: Green 1995).
#pragma once

#include "proposals.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <vector>

namespace palpate::footprints {

struct ParticleSettings {
  int count = 2000;
  double mistaken = 0.01;  ///< probability that a touch of an object has the label of the desk
  double lies = 0.01;      ///< probability that a touch of the desk has the label of an object
  /// Standard deviation of the place of a touch, along x and y, metres, if there is any: half of the outlines believe
  /// so at first, and half that places are exact.
  double blur = 0.0;
  /// Probability, between two touches, that the objects are pushed; an outline has been so once at most.
  double pushes = 0.0;
  /// Moves of each outline after a touch, over the share of outlines that its label leaves (the effective sample size:
  /// Kong, Liu and Wong 1994): a label that nobody expected leaves many copies of few outlines, which have to part.
  double moves = 4.0;
  int most_moves = 40;
};

/// What a label says of how far inside of an outline its touch was.
class LabelModel {
 public:
  LabelModel(const ParticleSettings& settings, double blur);

  /// How deep a place is within an outline, as far as it matters here: without a blur only whether it is within.
  double depth(const Outline& outline, const Target& place) const {
    if (blurs_) return outline.depth(place.x, place.y);
    return outline.contains(place.x, place.y) ? 1.0 : -1.0;
  }

  /// The probability of a label at this depth (metres; negative: outside).
  double probability(double depth, bool on) const { return at(depth, on).probability; }
  /// How much it speaks against the outline, 0 for a label that is right far from the rim; in units() of a logarithm.
  double loss(double depth, bool on) const { return at(depth, on).loss; }
  double units() const { return units_; }
  /// The loss of a touch: what moves of outlines are made of, and so without a detour over the depth where only in or
  /// out matters.
  double loss(const Outline& outline, const Target& place, bool on) const {
    if (blurs_) return loss(outline.depth(place.x, place.y), on);
    return entry(outline.contains(place.x, place.y) ? kSteps + 1 : 0, on).loss;
  }
  /// The probability that such a label is wrong, and not just on the other side of a rim by the blur of its place.
  double wrong(double depth, bool on) const { return at(depth, on).wrong; }

 private:
  struct Entry {
    double probability;
    double loss;
    double wrong;
  };
  static constexpr int kSteps = 128;  ///< over the depths at which the place decides
  const Entry& entry(int place, bool on) const {
    const int row = 2 * place + (on ? 1 : 0);
    return table_[static_cast<std::size_t>(row)];
  }
  const Entry& at(double depth, bool on) const {
    const double step = depth * steps_per_metre_ + 0.5 * kSteps;
    return entry(step < 0.0 ? 0 : step >= kSteps ? kSteps + 1 : 1 + static_cast<int>(step), on);
  }

  bool blurs_;
  double units_;
  double steps_per_metre_;
  std::vector<Entry> table_;
};

/// An outline, and what its moves ask for again and again. It is that of after its push.
struct Particle : State {
  int mistakes = 0;   ///< touches so far that it has wrong
  double loss = 0.0;  ///< what all of them say against it
  bool blurred = false;
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

  /// The probability that the label of each touch so far is wrong, and no blur accounts for it.
  void doubt(VectorOut out) const;

  /// Where each touch so far would be made now (rows as they were made; set already to where they were): elsewhere
  /// where more than half of the outlines were pushed since.
  void place_now(Points& places) const;
  /// Share of the outlines that were pushed, and the touches before it and the shift of an average one of these.
  struct Pushed {
    double share = 0.0;
    double before = 0.0;
    double shift = 0.0;  ///< of the first piece, metres
  };
  Pushed pushed() const;

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
  Target seen_from(const Particle& particle, std::size_t touch) const {
    const Target& place = touches_[touch].place;
    return static_cast<int>(touch) < particle.push.before ? particle.push.now(place) : place;
  }

  OutlinePrior prior_;
  ParticleSettings settings_;
  Random random_;
  std::vector<Particle> particles_;
  std::vector<Touch> touches_;
  const LabelModel& labels(bool blurred) const { return blurred ? blurred_ : exact_; }

  LabelModel exact_, blurred_;
  long tried_ = 0;
  long moved_ = 0;
};

}  // namespace palpate::footprints
