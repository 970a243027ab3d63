// SPDX-License-Identifier: MIT
// A surface some of whose taps may lie: lies.hpp over the taps of a process, and its maps over the candidates.
#pragma once

#include "gp/candidates.hpp"
#include "gp/gaussian_process.hpp"
#include "gp/outlier_posterior.hpp"

namespace palpate {

class RobustSurface {
 public:
  /// `candidates` must outlive it.
  explicit RobustSurface(const Candidates& candidates) : candidates_(candidates) {}

  /// Judges all taps of `process`, of which `suspicion` (a value each) is thought before their heights are compared,
  /// and whose noise has this variance beside the usual one (a value each, or empty). Without noise nobody is judged:
  /// the surface is that of the process.
  ///
  /// A process whose noise is below 3 % of its signal may be contradicted by true heights: its kernel is too
  /// smooth for the object. What deviates by much more than such a noise then looks like an outlier, and most taps are
  /// taken for outliers. So the evidence is compared with that of a rough arm's noise. Where the evidence is
  /// strong for that, the outliers are those that even a rough arm does not explain, and the surface is that of the
  /// process, which follows the heights as closely as its own noise says.
  void update(const GaussianProcess& process, const VectorView& suspicion, const Eigen::VectorXd& roughness = {});

  /// To be called before another process is judged.
  void reset();

  /// The probability that each tap lies; as suspected where nobody was judged.
  const Eigen::VectorXd& outlier_probabilities() const { return posterior_.probability; }

  /// Those that were judged last.
  int taps() const { return static_cast<int>(posterior_.probability.size()); }

  /// Whether any were: else the surface is that of the process.
  bool excludes_outliers() const { return judged_; }

  /// What rounding made necessary in the judgements so far, as far as they were used: the jitter of the last, in the
  /// square of the targets' unit, the factorisations of all that needed it, and how many taps are set aside now.
  const FactorReport& report() const { return report_; }
  /// How many variances of the last map rounding has taken below 0; they read as 0.
  int variances_clamped() const { return clamped_; }

  // Of the process that was judged, in the unit of the targets and its square; noise excluded.
  /// Over the candidates; these size `out`.
  void read_mean(const GaussianProcess& process, Eigen::VectorXd& out);
  void read_variance(const GaussianProcess& process, Eigen::VectorXd& out);
  /// At one of them, without any map.
  struct Height {
    double mean, variance;
  };
  Height at(const GaussianProcess& process, int candidate) const;

 private:
  void cover(const GaussianProcess& process);

  const Candidates& candidates_;
  OutlierPosterior posterior_;
  FactorReport report_;
  int clamped_ = 0;
  bool judged_ = false;
  Eigen::MatrixXd covariances_, broad_;  ///< candidates x taps: k and l of lies.hpp
  Eigen::Index covered_ = 0;             ///< taps
  int generation_ = -1;                  ///< of the hyperparameters that these were made with
};

}  // namespace palpate
