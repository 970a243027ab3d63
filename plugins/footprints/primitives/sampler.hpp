// SPDX-License-Identifier: MIT
// The posterior distribution of hypotheses given the taps, as equally probable particles. After each tap they are drawn
// again by their likelihood and moved by a Markov chain (resample-move: Gilks and Berzuini 2001). The chain has the
// density
//
//     rate^[push] f(push) expected^n density(1) ... density(n) P(labels | union, push, noisy) P(heights | primitives)
//
// of n primitives (in any order; hypothesis.hpp) that contain an object tap each, of a push (proposals.cpp) and of
// noisy positions (half of the hypotheses). Undiscovered primitives (undiscovered.hpp) are independent of these, up to
// the approximations that are stated where they are made.
#pragma once

#include "proposals.hpp"
#include "tap_model.hpp"
#include "undiscovered.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

struct SamplerSettings {
  /// Number of particles; doubled for ten taps after a find.
  int particles = 384;
  double label_error = 0.01;    ///< probability that a tap of an object has the label of the desk, in (0, 0.5]
  double false_contact = 0.01;  ///< probability that a tap of the desk has the label of an object, in (0, 0.5]
  /// Standard deviation of the positions of taps along x and y, metres. If above 0, half of the hypotheses have noisy
  /// positions before the first tap, and half have exact ones.
  double position_noise = 0.0;
  /// Prior weight of a push between two taps, relative to none. A hypothesis has one push at most.
  double push_probability = 0.0;
  bool heights = true;  ///< whether heights are part of the likelihood
  /// Moves per primitive and hole after each tap, and how many more per unit of N / ESS - 1 (effective sample size:
  /// Kong, Liu and Wong 1994): an improbable label leaves many copies of few particles, which have to move apart.
  double moves = 2.5;
  double moves_apart = 7.5;
  int most_moves = 200;  ///< per particle and tap
};

/// A hypothesis, and its likelihood: sums over all taps.
struct Particle {
  Hypothesis hypothesis;
  TapRows rows;          ///< of its primitives, with taps as seen after its push
  LogUnits loss = 0;     ///< of labels
  LogUnits heights = 0;  ///< evidence of heights

  RowList list_rows() const;
};

/// Replaces those primitives of `to` that the latest tap says something about by those of `from`: primitives near the
/// tap, and primitives that are close to one of these, or have an object tap in common, in either hypothesis. The
/// others stay, because a tap of one object says nothing about another (local particle filters: Rebeschini and van
/// Handel 2015). Otherwise few distinct hypotheses of one object would be left while another one is tapped. The
/// likelihood of `to` is left as it was. Returns false, and changes nothing, if no primitive would stay, if there would
/// be more than `most`, if either hypothesis has a push, or if only one has noisy positions. `taps`: as made.
///
/// An approximation: the weights of resampling are not corrected for the primitives that stay; the moves that follow
/// correct the particles. In the calibration with the moves of the defaults, no error was seen at 0.003.
bool exchange(const Particle& from, const Taps& taps, int most, Particle& to);

/// The taps, and how well a hypothesis explains them.
class Likelihood {
 public:
  explicit Likelihood(const SamplerSettings& settings);

  void add(const Touch& touch);
  /// The taps as made.
  const Taps& taps() const { return taps_; }
  /// The probabilities of labels for hypotheses with noisy or exact positions.
  const LabelModel& labels(bool noisy) const { return labels_[noisy ? 1 : 0]; }

  /// Returns the loss of all labels of a hypothesis with these rows.
  LogUnits loss(const RowList& rows, bool noisy);
  /// Returns the evidence of the heights of all object taps.
  LogUnits evidence(const RowList& rows);
  /// Sets both sums of a particle by its rows.
  void weigh(Particle& particle);
  /// Adds the step of the latest tap to the rows of a particle; returns that in the union of its primitives.
  LabelModel::Step add_latest(Particle& particle) const;

 private:
  bool has_heights_;
  std::array<LabelModel, 2> labels_;  ///< exact and noisy
  HeightModel heights_;
  Taps taps_;
  std::vector<LabelModel::Step> steps_;  ///< scratch, as the next
  std::vector<std::uint16_t> holders_;
};

/// The Markov chain.
class Mover {
 public:
  Mover(const Prior& prior, const SamplerSettings& settings) : prior_(prior), settings_(settings) {}

  /// Proposes `times` moves, and makes those that are accepted.
  void move(Particle& particle, int times, Likelihood& likelihood, Random& random);

  /// Share of accepted moves.
  double acceptance_rate() const {
    return tried_ > 0 ? static_cast<double>(accepted_) / static_cast<double>(tried_) : 0.0;
  }

 private:
  bool accept(Particle& particle, const Taps& taps, Likelihood& likelihood, Random& random);

  Prior prior_;
  SamplerSettings settings_;
  long tried_ = 0, accepted_ = 0;  ///< moves
  Proposal proposal_;              ///< kept to save allocations, as the next
  Taps seen_, pushed_;             ///< taps as seen after the push of the particle, and of the proposal
  TapRows added_;
};

/// Updates: sampler.cpp. Queries: sampler_queries.cpp. Positions are M x 2 metres.
class Sampler {
 public:
  /// Throws Error as Prior does.
  Sampler(const Prior& prior, const SamplerSettings& settings, Random random);

  /// Updates the particles by a tap. Returns the probability of its label before the tap.
  double add(const Touch& touch);

  // Queries must not run at the same time: they keep what the next one about the same positions needs.

  /// Sets `out` to the probability that each position is on an object.
  void probability(const PointsView& positions, VectorOut out);
  /// Draws `count` hypotheses, a multiple of 64, from the particles and the undiscovered primitives that overlap them.
  /// The particles are taken evenly, from a random one on.
  void sample(const PointsView& positions, int count, OutlineSample& out);
  /// Sets `out` to the probability that the label of each tap is an error. A label that noise of the position explains
  /// is none.
  void label_errors(VectorOut out) const;
  /// Replaces the positions of all taps by where they would be made now, if over half of the particles have a push
  /// since. `positions` holds where they were made.
  void current_positions(Points& positions) const;
  /// Returns the probability that an object at least `length` long, metres, is apart from all known primitives.
  double undiscovered_probability(double length) const;

  /// Return the mean number of improbable labels (LabelModel::contradicts) per particle, and of primitives.
  double mean_label_errors() const;
  double mean_primitives() const;
  /// Share of particles with a push, and their mean number of taps before it and mean shift of their primitives.
  struct MeanPush {
    double share = 0.0;
    double before = 0.0;
    double shift = 0.0;  ///< metres
  };
  MeanPush mean_push() const;
  double acceptance_rate() const { return mover_.acceptance_rate(); }

  int size() const { return static_cast<int>(particles_.size()); }
  const std::vector<Particle>& particles() const { return particles_; }

 private:
  void resample(const std::vector<double>& weights, double sum, std::size_t count);
  void find(const Undiscovered::Covering& covering, double p_new);
  int count_moves(double effective_share) const;
  /// Sets spans_ for these positions.
  void prepare(const PointsView& positions);
  /// Calls visit(tap, labels, step, on) for each tap of each particle with a loss.
  template <class Visit>
  void for_each_label(const Visit& visit) const;

  Prior prior_;
  SamplerSettings settings_;
  Random random_;
  std::uint64_t sample_seed_;
  Likelihood likelihood_;
  Mover mover_;
  Undiscovered undiscovered_;
  std::vector<Particle> particles_;
  int doubled_until_ = 0;  ///< number of taps until which there are twice as many particles
  /// What each particle covers of the positions of the latest query, unless there was a tap since.
  std::vector<Grid::Spans> spans_;
  bool prepared_ = false;
};

}  // namespace palpate::footprints
