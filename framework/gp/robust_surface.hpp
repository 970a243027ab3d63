// SPDX-License-Identifier: MIT
// Computes the surface of a GP without the influence of outliers, and the maps of this surface over the candidates.
#pragma once

#include "gp/candidate_grid.hpp"
#include "gp/gaussian_process.hpp"
#include "gp/outlier_posterior.hpp"

namespace palpate {

class RobustSurface {
 public:
  /// `candidates` must outlive the surface.
  explicit RobustSurface(const CandidateGrid& candidates) : candidates_(candidates) {}

  /// Computes the outlier probabilities of all taps of `gp`. `prior`: prior probability that each tap is an outlier.
  /// `extra_variance`: variance per tap in addition to the noise; empty for none. If the GP has no noise, no tap can be
  /// an outlier, and the surface is the posterior of the GP.
  ///
  /// If the noise of a GP is below 3 % of its signal, heights of inliers may contradict the GP, because its kernel is
  /// too smooth for the object. Most taps would then seem to be outliers. So the evidence of this noise is compared
  /// with the evidence of larger noises. If there is strong evidence for a larger noise, only taps that even the larger
  /// noise does not explain count as outliers. The surface is then the posterior of the GP, which follows the heights
  /// as closely as its own noise allows.
  void update(const GaussianProcess& gp, const VectorView& prior, const Eigen::VectorXd& extra_variance = {});

  /// Removes all taps. Must be called before update() with another GP.
  void reset();

  /// Returns the posterior probability that each tap is an outlier; the prior probability if no outlier was possible.
  const Eigen::VectorXd& outlier_probabilities() const { return posterior_.probability; }
  /// Returns the number of taps at the latest update().
  int taps() const { return static_cast<int>(posterior_.probability.size()); }
  /// Returns whether the surface excludes outliers; if not, the surface is the posterior of the GP.
  bool excludes_outliers() const { return excludes_outliers_; }

  /// Returns the report of the factorisations that were used: the latest jitter in the squared unit of the targets, all
  /// counts so far, and the number of currently redundant rows.
  const FactorReport& report() const { return report_; }
  /// Returns the number of variances in the latest map that were below 0 because of rounding. read_variance() sets them
  /// to 0.
  int variances_clamped() const { return clamped_; }

  // In these functions, `gp` must be the GP of the latest update(). Means are in the unit of its targets. Variances are
  // in the squared unit and do not contain the noise.
  /// Set `out` to the mean, or the variance, at all candidates.
  void read_mean(const GaussianProcess& gp, Eigen::VectorXd& out);
  void read_variance(const GaussianProcess& gp, Eigen::VectorXd& out);
  struct Height {
    double mean, variance;
  };
  /// Computes mean and variance at one candidate, without a map.
  Height at(const GaussianProcess& gp, int candidate) const;

 private:
  void update_covariances(const GaussianProcess& gp);

  const CandidateGrid& candidates_;
  OutlierPosterior posterior_;
  FactorReport report_;
  int clamped_ = 0;
  bool excludes_outliers_ = false;
  Eigen::MatrixXd covariances_, broad_;  ///< k and l of outlier_posterior.hpp: candidates x taps
  Eigen::Index covered_ = 0;             ///< number of taps whose columns are computed
  int generation_ = -1;                  ///< generation() of the GP when these columns were computed
};

}  // namespace palpate
