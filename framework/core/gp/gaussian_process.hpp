// SPDX-License-Identifier: MIT
// Gaussian processes that share their covariance, and their posterior over the candidates, updated tap by tap.
#pragma once

#include "gp/candidates.hpp"
#include "gp/engine.hpp"
#include "gp/factor.hpp"
#include "regular/regular_factor.hpp"

#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <memory>
#include <string>
#include <vector>

namespace palpate {

/// The numbers of a process that are not the kernel's; standard deviations and mean in the unit of the targets.
struct GpSettings {
  double signal = 1.0;
  double noise = 0.0;  ///< of one tap, independent from tap to tap, also at one place
  double mean = 0.0;   ///< prior mean, constant
  /// Standard deviation, in signals, of an unknown constant that is added to the mean; 0: the mean is known.
  double mean_ratio = 0.0;
};

/// Regression with a Gaussian process (Rasmussen and Williams 2006, algorithm 2.1) over a fixed set of candidates, of
/// one quantity or of several that were measured at the same places and have the same kernel and ratio of noise to
/// signal. These, the outputs, share all that does not depend on the targets: one factorisation, and one variance but
/// for its unit.
///
/// Inside, targets are standardised, (value - mean) / signal, and the covariance is that of the kernel plus
/// (noise / signal)^2 on the diagonal; every number that leaves is in the unit of the targets again, but for
/// relative_variance(). The maps are kept by one of the engines of engine.hpp; what earlier taps brought is never
/// computed again, unless the jitter, the hyperparameters or the engine change: then the state is rebuilt from the
/// taps, n updates of the maps and O(n^3) for the factor.
///
/// An unknown constant in the mean is integrated out (the same, section 2.7): its posterior needs L^-1 1, which grows
/// like L^-1 targets, and the map V^T L^-1 1.
///
/// A tap that makes the matrix singular in double precision (a duplicate without noise) raises the jitter: a variance
/// added to the whole diagonal and reported by jitter(); it is part of the model from then on. A matrix that is
/// singular even so (a kernel that is not positive definite) is factorised with pivoting, and taps that the others
/// already tell everything about are set aside: they stay recorded but do not enter the posterior.
class GaussianProcess {
 public:
  /// `candidates` must outlive the process. All `outputs` have the same noise / signal and mean_ratio, which may differ
  /// from 0 only for a single output. Throws Error if there is an objection() to `posterior`.
  GaussianProcess(std::shared_ptr<Kernel> kernel, std::vector<GpSettings> outputs, const Candidates& candidates,
                  EngineSettings posterior = {});

  /// Adds a tap, a value for each output.
  void add(const Target& place, const VectorView& values);

  int size() const { return size_; }

  /// How far each tap so far is to be trusted, in (0, 1]: the variance of its noise is divided by it. Rebuilds if that
  /// is another than before, and says whether. Taps are trusted fully at first; a fit takes them all so.
  bool trust(const VectorView& shares);

  /// Gives output 0 of all taps so far other values, and rebuilds if they are; says whether.
  bool correct(const VectorView& values);

  /// The same of the places of all taps so far, a row each.
  bool move(const PointsView& places);

  /// Lets the outputs below `outputs` have a map of their mean, at the cost of rebuilding the maps if that is more than
  /// before; at first only output 0 has one.
  void show(int outputs);
  int shown() const { return shown_; }

  /// Has the maps follow all that was said since: they cost most, so that what is not read is not kept. What reads them
  /// before, throws std::logic_error.
  void update_maps();

  // Of the maps. These size `out`.
  /// Posterior mean over the candidates, unit of the targets, of an output that is shown.
  void read_mean(int output, Eigen::VectorXd& out) const;
  /// Posterior variance over the candidates, noise excluded, square of the unit of the targets; in [0, prior].
  void read_variance(int output, Eigen::VectorXd& out) const;
  /// The same relative to the prior variance of each candidate; in [0, 1].
  void read_relative_variance(Eigen::VectorXd& out) const;

  /// log p(targets), natural logarithm, targets in their unit. 0 without taps.
  double log_marginal_likelihood(int output = 0) const;

  /// r^T K^-1 r of the standardised targets r of an output, an unknown constant integrated out: about the number of
  /// taps (less one for the constant) where the signal is that of the data, and by the ratio of variances more or less
  /// where it is not. 0 without taps.
  double misfit(int output = 0) const;

  /// The variance added to the diagonal by need, square of the unit of the targets.
  double jitter(int output = 0) const { return report_.jitter * settings(output).signal * settings(output).signal; }
  /// How often jitter was raised, and how often pivoting was the last resort.
  int jitter_raised() const { return report_.raised; }
  int pivoted() const { return report_.pivoted; }
  /// How many taps do not enter the posterior.
  int redundant_taps() const { return size_ - factor_.size(); }
  /// Of the maps: how many candidates' variances rounding has taken out of [0, prior] by now; they read as its ends.
  int variances_clamped() const;
  /// Estimate of the condition number of the covariance of the taps, noise and jitter included.
  double condition() const { return factor_.condition(); }

  /// The engine in use, why, and a bound of what it adds to the rounding of `dense`, of means in prior standard
  /// deviations and of variances in prior variances: with p the largest kernel variance of a candidate, e_i the largest
  /// error of a covariance of tap i, e that of all, c_i the rows of L^-1, s the noise and alpha = L^-T L^-1 targets,
  ///     2 E + E^2,  E = min(e sqrt(sum |c_i|_1^2), |(e_i)|_2 / s) / sqrt(p),   and   sum e_i |alpha_i| / sqrt(p).
  const char* engine() const { return choice_.engine->name(); }
  const std::string& engine_reason() const { return choice_.reason; }
  double error_bound() const;

  /// Where all taps were made, n x 2, and their targets of an output, as given.
  PointsView places() const { return points_.topRows(size_); }
  VectorView targets(int output = 0) const { return targets_.col(output).head(size_); }
  /// Rises with every change of the hyperparameters, and of the places of taps.
  int generation() const { return generation_; }

  const GpSettings& settings(int output = 0) const { return outputs_[static_cast<std::size_t>(output)]; }
  const Kernel& kernel() const { return *kernel_; }

  /// Lets `fitting` choose the hyperparameters from the taps, and rebuilds if it changed them. Numbers that are not
  /// finite and positive are refused: then the old ones stay.
  FitSummary fit(const Fitting& fitting, Random& random);

 private:
  bool with_constant() const { return outputs_.front().mean_ratio > 0.0; }
  double noise_ratio() const { return outputs_.front().noise / outputs_.front().signal; }
  double prior_of_constant() const { return outputs_.front().mean_ratio * outputs_.front().mean_ratio; }

  const Maps& maps() const {
    require_maps();
    return choice_.engine->maps();
  }
  void require_maps() const;
  void take_prior();
  void reserve(int taps);
  void choose(double error = 0.0);
  bool append(int tap);
  void absorb(int row);
  void take_rows();
  void rebuild();
  bool refactor(const std::vector<int>& taps);
  /// Precision of the unknown constant after the taps: 1 / mean_ratio^2 + 1^T K^-1 1.
  double constant_precision() const;
  /// Posterior mean of the constant in signals.
  double constant_mean() const;
  void read_standard_variance(Eigen::VectorXd& out) const;
  /// The same in [0, prior], times `scale`.
  void read_bound_variance(double scale, Eigen::VectorXd& out) const;
  /// Calls use(prior variance with that of the constant, at each candidate).
  template <class Use>
  void with_prior(const Use& use) const;

  std::shared_ptr<Kernel> kernel_;
  std::vector<GpSettings> outputs_;
  const Candidates& candidates_;
  EngineSettings posterior_;
  EngineChoice choice_;
  int shown_ = 1;
  Eigen::VectorXd prior_;  ///< kernel variance at each candidate; one number if it is the same at all
  bool same_prior_ = true;

  int size_ = 0;
  Points points_;            ///< first size_ rows, in the order of the taps
  Eigen::MatrixXd targets_;  ///< as given, an output a column
  Eigen::VectorXd trust_;    ///< in each tap

  Factor factor_;
  Points factored_;  ///< the points of the rows of factor_: those of the taps unless some are set aside
  /// L^-1 of the standardised targets, an output a column; with an unknown constant, L^-1 1 in the column after.
  Eigen::MatrixXd reduced_;
  /// Rows of the factor that the maps have; they begin anew where it is kNothing.
  int taken_ = kNothing;
  static constexpr int kNothing = -1;
  Eigen::MatrixXd weights_;     ///< L^-T of the same, of the rows that the engine has taken; only where it needs L^-1
  double inverse_norms_ = 0.0;  ///< sum of |c_i|_1^2 over those rows
  Eigen::VectorXd scratch_;
  FactorReport report_;             ///< jitter relative to signal^2; of what is set aside factor_ knows
  std::vector<double> fit_memory_;  ///< what one fit leaves for the next
  int generation_ = 0;
};

}  // namespace palpate
