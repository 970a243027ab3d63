// SPDX-License-Identifier: MIT
// The surface of a GP without outliers, and its maps over the candidates.
#pragma once

#include "gp/candidate_grid.hpp"
#include "gp/gaussian_process.hpp"
#include "gp/outlier_posterior.hpp"

namespace palpate {

class RobustSurface {
 public:
  /// `candidates` must outlive the surface.
  explicit RobustSurface(const CandidateGrid& candidates) : candidates_(candidates) {}

  /// Computes the outlier probabilities of all taps of `gp`. `prior`: probability of an outlier per tap, before the
  /// heights are compared. `extra_variance`: variance per tap in addition to the noise; empty for none. Without noise
  /// no tap can be an outlier, and the surface is the posterior of the GP.
  ///
  /// Heights of inliers may contradict a GP whose noise is below 3 % of its signal, because its kernel is too smooth
  /// for the object. Most taps would then seem to be outliers. So the evidence is compared with the evidence of larger
  /// noises. If the evidence for a larger noise is strong, outliers are the taps that even this noise does not explain.
  /// The surface is then the posterior of the GP, which follows the heights as closely as its own noise allows.
  void update(const GaussianProcess& gp, const VectorView& prior, const Eigen::VectorXd& extra_variance = {});

  /// Forgets the taps. Call it before update() with another GP.
  void reset();

  /// Posterior probability of an outlier per tap; the prior if no outlier was possible.
  const Eigen::VectorXd& outlier_probabilities() const { return posterior_.probability; }
  /// Number of taps at the latest update().
  int taps() const { return static_cast<int>(posterior_.probability.size()); }
  /// Returns whether the surface excludes outliers; else it is the surface of the GP.
  bool excludes_outliers() const { return excludes_outliers_; }

  /// Report of the factorisations that were used: the latest jitter, in the square of the targets' unit, all counts so
  /// far, and the rows that are redundant now.
  const FactorReport& report() const { return report_; }
  /// Number of variances of the latest map that rounding has moved below 0; they read as 0.
  int variances_clamped() const { return clamped_; }

  // `gp` must be the GP of the latest update(). Results have the unit of its targets and its square, without noise.
  /// Maps over the candidates. Both resize `out`.
  void read_mean(const GaussianProcess& gp, Eigen::VectorXd& out);
  void read_variance(const GaussianProcess& gp, Eigen::VectorXd& out);
  struct Height {
    double mean, variance;
  };
  /// Computes the surface at one candidate, without a map.
  Height at(const GaussianProcess& gp, int candidate) const;

 private:
  void update_covariances(const GaussianProcess& gp);

  const CandidateGrid& candidates_;
  OutlierPosterior posterior_;
  FactorReport report_;
  int clamped_ = 0;
  bool excludes_outliers_ = false;
  Eigen::MatrixXd covariances_, broad_;  ///< candidates x taps: k and l of outlier_posterior.hpp
  Eigen::Index covered_ = 0;             ///< taps whose columns are computed
  int generation_ = -1;                  ///< generation() of the GP for these columns
};

}  // namespace palpate
