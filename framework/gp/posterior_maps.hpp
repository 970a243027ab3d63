// SPDX-License-Identifier: MIT
// Posterior means and variance of a GP over the candidates, updated by an engine (engine.hpp).
#pragma once

#include "gp/candidate_grid.hpp"
#include "gp/engine.hpp"
#include "gp/factor.hpp"

#include <optional>
#include <string>

namespace palpate {

/// Posterior of an unknown constant in the mean of a GP, in units of the signal (Rasmussen and Williams 2006, section
/// 2.7).
struct UnknownMean {
  double mean = 0.0;
  double precision = 0.0;
  double prior_variance = 0.0;
};

/// The taps of a posterior in the order of the factor's rows.
struct FactoredTaps {
  Factor& factor;           ///< Cholesky factor L of the covariance of the taps
  const Points& positions;  ///< one row per tap, with reserved rows at the end
  /// L^-1 B. B contains the standardised targets, one column per output, and a column of ones if the mean is unknown.
  const Eigen::MatrixXd& solved;
  double noise;                        ///< standard deviation of noise and jitter, in units of the signal
  std::optional<UnknownMean> unknown;  ///< absent if the mean is known
};

/// The engine that computes the maps of a GP.
struct EngineReport {
  const char* name;
  std::string reason;  ///< reason for the choice of the engine, one line
  /// Bound of the engine's error, in addition to the rounding of `dense`. Errors of means are in prior standard
  /// deviations, errors of variances in prior variances. The bound is the larger of
  ///     2 E + E^2,  E = min(e sqrt(sum |c_i|_1^2), |(e_i)|_2 / s) / sqrt(p),   and   sum e_i |alpha_i| / sqrt(p).
  /// where
  ///     e_i    largest error of the covariances of tap i; e is the largest e_i
  ///     p      largest kernel variance of a candidate
  ///     c_i    rows of L^-1
  ///     s      noise, jitter included
  ///     alpha  L^-T L^-1 targets
  /// An unknown mean adds a term to each of these two values.
  double error_bound;
};

/// Maps over the candidates (MapTiles). Each row of the factor updates the maps once. After a restart, the maps are
/// computed again from all rows. An unknown mean allows only one output, and needs one more map: V^T L^-1 1, the part
/// of the constant that the taps explain. The functions that read maps resize `out` to the number of candidates.
class PosteriorMaps {
 public:
  /// `kernel` and `candidates` must outlive the maps. Throws Error if there is an objection() to `settings`.
  PosteriorMaps(const Kernel& kernel, const CandidateGrid& candidates, EngineSettings settings, int outputs,
                bool unknown_mean);

  /// Returns the number of columns of FactoredTaps::solved.
  Eigen::Index columns() const { return outputs_ + (unknown_mean_ ? 1 : 0); }
  const EngineSettings& settings() const { return settings_; }
  double largest_prior() const { return prior_.maxCoeff(); }

  /// Reserves memory for this many taps.
  void reserve(int taps);
  /// Computes the prior and chooses an engine for the present hyperparameters of the kernel. Restarts the maps.
  void take_hyperparameters();
  /// Restarts the maps. Must be called if rows of the factor have changed.
  void restart() { rows_ = kNoRows; }
  /// Keeps maps of the means of the outputs 0 to `outputs` - 1. Restarts the maps if fewer maps were kept before.
  void show(int outputs);
  int shown() const { return shown_; }

  /// Updates the maps with the rows that they do not contain yet. With the engine type `automatic`, an engine that is
  /// not accurate enough is replaced.
  void update(const FactoredTaps& taps);
  /// Returns whether the maps contain this number of rows. The functions below require maps that contain all rows of
  /// the factor.
  bool have_rows(int rows) const { return rows_ == rows; }

  EngineReport engine() const { return {choice_.engine->name(), choice_.reason, error_bound()}; }
  /// Sets `out` to the standardised mean of a shown output, times `signal`, plus `mean`.
  void read_mean(int output, double signal, double mean, Eigen::VectorXd& out) const;
  /// Sets `out` to the variance without noise, bounded to [0, prior], times `scale`.
  void read_variance(double scale, Eigen::VectorXd& out) const;
  /// Sets `out` to the variance without noise, divided by the prior variance, in [0, 1].
  void read_relative_variance(Eigen::VectorXd& out) const;
  /// Returns the number of candidates whose variance is outside of [0, prior] because of rounding.
  int variances_clamped() const;

 private:
  void choose(double error);
  void take_rows(const FactoredTaps& taps);
  void absorb(const FactoredTaps& taps, int row);
  double error_bound() const;
  /// Sets `out` to the variance before it is bounded.
  void read_raw_variance(Eigen::VectorXd& out) const;
  /// Calls use(v), where v contains the prior variance at each candidate, the prior variance of an unknown mean
  /// included.
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
  int rows_ = kNoRows;     ///< number of the factor's rows that the maps contain
  static constexpr int kNoRows = -1;
  double noise_ = 0.0;  ///< FactoredTaps::noise of the latest update(); `unknown_` is from the same update
  std::optional<UnknownMean> unknown_;
  Eigen::MatrixXd weights_;     ///< L^-T L^-1 B, one row per tap; only for engines that need L^-1
  double inverse_norms_ = 0.0;  ///< sum over the rows of the squared 1-norm of the row of L^-1
  Eigen::VectorXd inverse_;     ///< scratch: a row of L^-1
};

}  // namespace palpate
