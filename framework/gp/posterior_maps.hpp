// SPDX-License-Identifier: MIT
// Posterior means and variance of a GP over the candidates, updated by an engine (engine.hpp).
#pragma once

#include "gp/candidate_grid.hpp"
#include "gp/engine.hpp"
#include "gp/factor.hpp"

#include <optional>
#include <string>

namespace palpate {

/// Posterior of an unknown constant in the mean of a GP, in signals (Rasmussen and Williams 2006, section 2.7).
struct UnknownMean {
  double mean = 0.0;
  double precision = 0.0;
  double prior_variance = 0.0;
};

/// The taps of a posterior in the order of the factor's rows.
struct FactoredTaps {
  Factor& factor;                 ///< L, of their covariance
  const Points& positions;        ///< one row per tap, with reserved rows at the end
  const Eigen::MatrixXd& solved;  ///< L^-1 B, B one column of standardised targets per output, 1 for an unknown mean
  double noise;                   ///< standard deviation of noise and jitter, in signals
  std::optional<UnknownMean> unknown;  ///< absent if the mean is known
};

/// The engine that computes the maps of a GP.
struct EngineState {
  const char* name;
  std::string reason;  ///< reason of its choice, one line
  /// Bound of the error beyond the rounding of `dense`, of means in prior standard deviations and of variances in prior
  /// variances. With p the largest kernel variance of a candidate, e_i the largest error of a covariance of tap i, e
  /// the largest of these, c_i the rows of L^-1, s the noise and alpha = L^-T L^-1 targets, it is the larger of
  ///     2 E + E^2,  E = min(e sqrt(sum |c_i|_1^2), |(e_i)|_2 / s) / sqrt(p),   and   sum e_i |alpha_i| / sqrt(p).
  double error_bound;
};

/// Maps over the candidates that follow the rows of a factor. A row is computed once, unless the maps restart. With an
/// unknown mean, which allows only one output, one more map has the part of the constant that the taps explain,
/// V^T L^-1 1. The functions that read maps resize `out` to the number of candidates.
class PosteriorMaps {
 public:
  /// `kernel` and `candidates` must outlive the maps. Throws Error if there is an objection() to `settings`.
  PosteriorMaps(const Kernel& kernel, const CandidateGrid& candidates, EngineSettings settings, int outputs,
                bool unknown_mean);

  /// Number of columns of FactoredTaps::solved.
  Eigen::Index columns() const { return outputs_ + (unknown_mean_ ? 1 : 0); }
  const EngineSettings& settings() const { return settings_; }
  double largest_prior() const { return prior_.maxCoeff(); }

  /// Reserves memory for this many taps.
  void reserve(int taps);
  /// Computes the prior and chooses an engine for the present hyperparameters of the kernel. Restarts the maps.
  void take_hyperparameters();
  /// Restarts the maps, because the rows of the factor change.
  void restart() { rows_ = kNoRows; }
  /// Keeps a mean of the outputs 0 to `outputs` - 1. Restarts the maps if they had fewer.
  void show(int outputs);
  int shown() const { return shown_; }

  /// Adds the rows that the maps do not have yet. With the engine `automatic`, changes an engine that is not accurate
  /// enough.
  void update(const FactoredTaps& taps);
  /// Whether the maps have this number of rows. The functions below require all rows.
  bool have_rows(int rows) const { return rows_ == rows; }

  EngineState engine() const { return {choice_.engine->name(), choice_.reason, error_bound()}; }
  /// Reads the mean of a shown output, times `signal`, plus `mean`.
  void read_mean(int output, double signal, double mean, Eigen::VectorXd& out) const;
  /// Reads the variance without noise, bounded to [0, prior], times `scale`.
  void read_variance(double scale, Eigen::VectorXd& out) const;
  /// Reads the variance without noise relative to the prior, in [0, 1].
  void read_relative_variance(Eigen::VectorXd& out) const;
  /// Returns the number of candidates whose variance rounding has moved out of [0, prior].
  int variances_clamped() const;

 private:
  void choose(double error);
  void take_rows(const FactoredTaps& taps);
  void absorb(const FactoredTaps& taps, int row);
  double error_bound() const;
  /// Reads the variance as it is in the maps.
  void read_raw_variance(Eigen::VectorXd& out) const;
  /// Calls use(prior variance at each candidate, with the prior variance of an unknown mean).
  template <class Use>
  void with_prior(const Use& use) const;

  const Kernel& kernel_;
  const CandidateGrid& candidates_;
  EngineSettings settings_;
  int outputs_;
  bool unknown_mean_;
  EngineChoice choice_;
  int shown_ = 1;
  Eigen::VectorXd prior_;  ///< kernel variance at each candidate; one value if all are equal
  int rows_ = kNoRows;     ///< rows of the factor in the maps
  static constexpr int kNoRows = -1;
  double noise_ = 0.0;  ///< noise of the latest update(), also for `unknown_`
  std::optional<UnknownMean> unknown_;
  Eigen::MatrixXd weights_;     ///< L^-T L^-1 B of the rows, one row per tap; only for engines that need L^-1
  double inverse_norms_ = 0.0;  ///< sum over the rows of the squared 1-norm of the row of L^-1
  Eigen::VectorXd inverse_;     ///< scratch: a row of L^-1
};

}  // namespace palpate
