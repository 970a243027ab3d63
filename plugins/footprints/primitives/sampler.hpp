// SPDX-License-Identifier: MIT
// Posterior distribution of hypotheses given the taps, as equally weighted particles. After each tap they are resampled
// by their likelihood and moved by a Markov chain (resample-move: Gilks and Berzuini 2001). The target density of the
// chain is
//
//     rate^[push] * f(push) * expected^n * density(1) * ... * density(n)
//         * P(labels | union, push, noisy) * P(heights | primitives)
//
// for n unordered primitives (hypothesis.hpp) with at least one object tap each, a push (proposals.cpp), and noisy
// positions with prior probability 1/2. [push] is 1 with a push and 0 without one; f is the prior density of its
// displacement. Undiscovered primitives (undiscovered.hpp) are independent of these primitives, up to approximations
// that are documented with the code.
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
  /// Number of particles; doubled for ten taps after a discovery.
  int particles = 384;
  double label_error = 0.01;    ///< probability that an object tap has the label of the desk, in (0, 0.5]
  double false_contact = 0.01;  ///< probability that a desk tap has the label of an object, in (0, 0.5]
  /// Standard deviation of tap positions along x and y, metres. If above 0, half of the initial hypotheses have noisy
  /// positions, the others exact ones.
  double position_noise = 0.0;
  /// Prior weight of a push between two taps, relative to no push. A hypothesis has at most one push.
  double push_probability = 0.0;
  bool heights = true;  ///< whether heights are part of the likelihood
  /// Moves per primitive and hole after each tap, and additional moves per unit of N / ESS - 1 (effective sample size:
  /// Kong, Liu and Wong 1994). An improbable label leaves many copies of few particles, which must diversify.
  double moves = 2.5;
  double moves_apart = 7.5;
  int most_moves = 200;  ///< per particle and tap
};

/// A hypothesis with its likelihood, summed over all taps.
struct Particle {
  Hypothesis hypothesis;
  TapRows rows;          ///< depths of the taps in its primitives; the taps are at their positions after its push
  LogUnits loss = 0;     ///< loss of the labels
  LogUnits heights = 0;  ///< evidence of the heights

  RowList list_rows() const;
};

/// Copies those primitives of `from` to `to` about which the latest tap is informative. They replace the corresponding
/// primitives of `to`. The tap is informative about primitives near it, and about primitives that are close to them or
/// share an object tap with them, in either hypothesis. Other primitives stay, because a tap of one object carries no
/// information about another (local particle filters: Rebeschini and van Handel 2015). Without this rule few distinct
/// hypotheses of an object would survive while another object is tapped. The likelihood of `to` is not updated. Returns
/// false, without a change, in four cases: no primitive would stay; more than `most` would result; a hypothesis has a
/// push; only one hypothesis has noisy positions. `taps` are at their original positions.
///
/// This is an approximation: the resampling weights are not corrected for the primitives that stay. The subsequent
/// moves correct the particles. A calibration with the default moves showed no error at a resolution of 0.003.
bool resample_partially(const Particle& from, const Taps& taps, int most, Particle& to);

/// Taps and their likelihood under a hypothesis.
class Likelihood {
 public:
  explicit Likelihood(const SamplerSettings& settings);

  void add(const Touch& touch);
  /// Returns the taps at their original positions.
  const Taps& taps() const { return taps_; }
  /// Returns the model of labels for noisy or exact positions.
  const LabelModel& labels(bool noisy) const { return labels_[noisy ? 1 : 0]; }

  /// Returns the loss of all labels for a hypothesis with these rows.
  LogUnits loss(const RowList& rows, bool noisy);
  /// Returns the evidence of the heights of all object taps.
  LogUnits evidence(const RowList& rows);
  /// Sets loss and heights of a particle from its rows.
  void weigh(Particle& particle);
  /// Appends the step of the latest tap to the particle's rows; returns its step in the union of the primitives.
  LabelModel::Step add_latest(Particle& particle) const;

 private:
  bool has_heights_;
  std::array<LabelModel, 2> labels_;  ///< exact and noisy
  TapHeightModel heights_;
  Taps taps_;
  std::vector<LabelModel::Step> steps_;  ///< scratch memory, like holders_
  std::vector<std::uint16_t> holders_;
};

/// Markov chain that moves a particle.
class MarkovChain {
 public:
  MarkovChain(const Prior& prior, const SamplerSettings& settings) : prior_(prior), settings_(settings) {}

  /// Proposes `times` moves and applies the accepted ones.
  void move(Particle& particle, int times, Likelihood& likelihood, Random& random);

  /// Returns the fraction of accepted moves.
  double acceptance_rate() const {
    return tried_ > 0 ? static_cast<double>(accepted_) / static_cast<double>(tried_) : 0.0;
  }

 private:
  bool accept(Particle& particle, const Taps& taps, Likelihood& likelihood, Random& random);

  Prior prior_;
  SamplerSettings settings_;
  long tried_ = 0, accepted_ = 0;  ///< moves
  Proposal proposal_;              ///< reused memory, like the members below
  Taps seen_, pushed_;             ///< taps after the push of the particle, and of the proposal
  TapRows added_;
};

/// Particle filter of the footprint. Updates are in sampler.cpp, queries in sampler_queries.cpp. Positions are M x 2
/// metres.
class Sampler {
 public:
  /// Throws Error under the conditions of Prior.
  Sampler(const Prior& prior, const SamplerSettings& settings, Random random);

  /// Updates the particles with a tap. Returns the probability of its label before the tap.
  double add(const Touch& touch);

  // Queries must not run concurrently, because they cache values for the same positions.

  /// Sets `out` to the probability that each position is on an object.
  void probability(const PointsView& positions, VectorOut out);
  /// Draws `count` hypotheses, a multiple of 64, from the particles and the overlapping undiscovered primitives.
  /// Particles are used evenly, starting at a random one.
  void sample(const PointsView& positions, int count, HypothesisSample& out);
  /// Sets `out` to the probability that each tap's label is an error. A label that noise of the position explains does
  /// not count as an error.
  void label_errors(VectorOut out) const;
  /// Moves the positions of earlier taps together with the pushed objects. A tap's position is moved if more than half
  /// of the particles have a push after this tap. `positions` contains the original positions.
  void current_positions(Points& positions) const;
  /// Returns the probability that an object of at least `length` metres exists apart from all known primitives.
  double undiscovered_probability(double length) const;

  /// Return the mean number of improbable labels (LabelModel::contradicts) per particle, and the mean number of
  /// primitives.
  double mean_label_errors() const;
  double mean_primitives() const;
  /// Fraction of particles with a push, their mean number of taps before it, and the mean translation of their
  /// primitives.
  struct MeanPush {
    double share = 0.0;
    double before = 0.0;
    double shift = 0.0;  ///< metres
  };
  MeanPush mean_push() const;
  double acceptance_rate() const { return chain_.acceptance_rate(); }

  int size() const { return static_cast<int>(particles_.size()); }
  const std::vector<Particle>& particles() const { return particles_; }

 private:
  void resample(const std::vector<double>& weights, double sum, std::size_t count);
  void discover(const UndiscoveredPrimitives::CoveringDraws& covering, double p_new);
  int count_moves(double effective_share) const;
  /// Computes spans_ for these positions.
  void prepare(const PointsView& positions);
  /// Calls visit(tap, labels, step, on) for each tap in each particle with a loss above 0.
  template <class Visit>
  void for_each_label(const Visit& visit) const;

  Prior prior_;
  SamplerSettings settings_;
  Random random_;
  std::uint64_t sample_seed_;
  Likelihood likelihood_;
  MarkovChain chain_;
  UndiscoveredPrimitives undiscovered_;
  std::vector<Particle> particles_;
  int doubled_until_ = 0;  ///< the number of particles is doubled until this number of taps
  /// Cached positions that each particle covers, of the latest query; invalid after a tap.
  std::vector<CoverageGrid::Spans> spans_;
  bool prepared_ = false;
};

}  // namespace palpate::footprints
