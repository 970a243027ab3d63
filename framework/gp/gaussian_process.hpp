// SPDX-License-Identifier: MIT
// Gaussian process over the candidates, with one or several outputs that share one covariance, updated tap by tap.
#pragma once

#include "gp/posterior_maps.hpp"
#include "regular/regular_factor.hpp"

#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

/// Parameters of a GP, in addition to the parameters of its kernel. Standard deviations and mean are in the unit of the
/// targets.
struct GpSettings {
  double signal = 1.0;
  double noise = 0.0;  ///< noise of one tap, independent between taps, even at the same position
  double mean = 0.0;   ///< prior mean, constant
  /// Standard deviation, divided by the signal, of an unknown constant that is added to the mean; 0 if the mean is
  /// known.
  double mean_ratio = 0.0;
};

/// Statistics of a GP given its taps, for one output.
struct GpDiagnostics {
  /// Natural logarithm of the density p(targets), with the targets in their unit. 0 without taps.
  double log_marginal_likelihood = 0.0;
  /// r^T K^-1 r for the standardised targets r; an unknown constant is integrated out. If the signal is right, the
  /// expected value is the number of taps (less 1 for the constant). If the signal is wrong, the expected value is
  /// multiplied by the true variance divided by the assumed variance. 0 without taps.
  double misfit = 0.0;
  FactorReport factors;    ///< jitter in the squared unit of the targets
  double condition = 1.0;  ///< estimated condition number of the taps' covariance, noise and jitter included
};

/// Regression with a Gaussian process (Rasmussen and Williams 2006, algorithm 2.1) over a fixed set of candidates. A GP
/// has one or several outputs: quantities that are measured at the same positions, with the same kernel and the same
/// ratio of noise to signal. The outputs share one factorisation, and their variances differ only by the factor
/// signal^2.
///
/// Internally, targets are standardised to (value - mean) / signal. The covariance is the covariance of the kernel,
/// plus (noise / signal)^2 on the diagonal. Results are converted back to the unit of the targets. A tap costs one
/// update of the maps. If the jitter or the hyperparameters change, everything is computed again: n updates of the
/// maps, and O(n^3) for the factor.
///
/// An unknown constant in the mean is integrated out (the same book, section 2.7). The posterior of the constant needs
/// the vector L^-1 1, where 1 is the vector of ones, and the map V^T L^-1 1 (engine.hpp defines L and V). Each tap also
/// updates L^-1 1 and V^T L^-1 1.
///
/// A tap that makes the matrix singular in double precision, such as a duplicate without noise, raises the jitter. The
/// jitter is a variance on the whole diagonal and part of the model from then on. If no jitter helps, because the
/// kernel is not positive definite, the matrix is factorised with pivoting. Taps whose rows depend on the rows of other
/// taps are then redundant: they are recorded, but not part of the posterior.
class GaussianProcess {
 public:
  /// `candidates` must outlive the GP. All `outputs` must have the same ratio noise / signal and the same mean_ratio.
  /// mean_ratio may differ from 0 only if there is a single output. Throws Error if there is an objection() to
  /// `engine`.
  GaussianProcess(std::shared_ptr<Kernel> kernel, std::vector<GpSettings> outputs, const CandidateGrid& candidates,
                  EngineSettings engine = {});

  /// Adds a tap with one value per output.
  void add(const Target& position, const VectorView& values);
  int size() const { return size_; }

  /// Sets the trust in each tap, in (0, 1]. The variance of a tap's noise is divided by its trust. New taps have the
  /// trust 1; fits ignore the trust. Returns whether a value changed; if so, everything is computed again.
  bool set_trust(const VectorView& trust) { return replace(trust_.head(size_), trust); }
  /// Sets the values of output 0 of all taps. Returns whether a value changed; if so, everything is computed again.
  bool set_targets(const VectorView& values) { return replace(targets_.col(0).head(size_), values); }
  /// Sets the positions of all taps, one row per tap. Returns whether a position changed; if so, everything is computed
  /// again.
  bool set_positions(const PointsView& positions);

  /// Keeps maps of the means of the outputs 0 to `outputs` - 1. At first, only the map of output 0 is kept. If fewer
  /// maps were kept before, all maps are computed again.
  void show(int outputs) { maps_.show(outputs); }
  int shown() const { return maps_.shown(); }

  /// Updates the maps with all changes since the last call. The functions from read_mean() to variances_clamped() throw
  /// std::logic_error if the maps are older than the taps.
  void update_maps();
  /// Sets `out` to the posterior mean of a shown output at all candidates, in the unit of the targets.
  void read_mean(int output, Eigen::VectorXd& out) const {
    maps().read_mean(output, settings(output).signal, settings(output).mean, out);
  }
  /// Sets `out` to the posterior variance without noise at all candidates, in the squared unit of the targets, in [0,
  /// prior].
  void read_variance(int output, Eigen::VectorXd& out) const {
    maps().read_variance(settings(output).signal * settings(output).signal, out);
  }
  /// Sets `out` to the posterior variance without noise, relative to the prior variance of each candidate, in [0, 1].
  void read_relative_variance(Eigen::VectorXd& out) const { maps().read_relative_variance(out); }
  EngineReport engine() const { return maps().engine(); }
  /// Returns the number of candidates whose variance is outside of [0, prior] because of rounding. read_variance() sets
  /// these variances to the bounds.
  int variances_clamped() const { return maps().variances_clamped(); }

  GpDiagnostics diagnostics(int output = 0) const;

  /// Return the positions of all taps (n x 2), and the targets of all taps for one output, as given to add() or set
  /// later.
  PointsView positions() const { return positions_.topRows(size_); }
  VectorView targets(int output = 0) const { return targets_.col(output).head(size_); }
  /// Returns a counter that increases with every change of the hyperparameters or of a tap's position.
  int generation() const { return generation_; }
  const GpSettings& settings(int output = 0) const { return outputs_[static_cast<std::size_t>(output)]; }
  const Kernel& kernel() const { return *kernel_; }

  /// Lets `fitting` choose the hyperparameters from the taps, and computes everything again if they changed. If a
  /// hyperparameter is not finite and positive, the result is rejected, and the old hyperparameters are kept.
  FitSummary fit(const Fitting& fitting, Random& random);

 private:
  double noise_ratio() const { return outputs_.front().noise / outputs_.front().signal; }
  std::optional<UnknownMean> unknown_mean() const;
  /// Throws std::logic_error if the maps are older than the taps.
  const PosteriorMaps& maps() const;

  void reserve(int taps);
  bool append(int tap);
  bool factorise(const std::vector<int>& taps);
  void rebuild();
  /// Replaces `data` by `values`, and rebuilds the factor if they differ. Returns whether they differ.
  template <class Data, class Values>
  bool replace(Data data, const Values& values) {
    if (data == values) return false;
    data = values;
    rebuild();
    return true;
  }

  std::shared_ptr<Kernel> kernel_;
  std::vector<GpSettings> outputs_;
  PosteriorMaps maps_;

  int size_ = 0;
  Points positions_;         ///< the first size_ rows, in the order of the taps
  Eigen::MatrixXd targets_;  ///< targets as given, one column per output
  Eigen::VectorXd trust_;

  Factor factor_;
  Points factored_;                 ///< positions of the factor's rows: all taps except the redundant ones
  Eigen::MatrixXd solved_;          ///< L^-1 B, where B contains the standardised targets; see FactoredTaps
  Eigen::VectorXd covariance_;      ///< scratch: covariances of the new tap with the earlier taps
  FactorReport report_;             ///< jitter divided by signal^2; redundant taps are not counted here
  std::vector<double> fit_memory_;  ///< numbers that a fit stores for the next fit
  int generation_ = 0;
};

}  // namespace palpate
