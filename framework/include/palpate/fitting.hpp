// SPDX-License-Identifier: MIT
// Plugin kind `fitting`: chooses the hyperparameters of a Gaussian process from its taps.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/random.hpp>

#include <string>
#include <vector>

namespace palpate {

/// One output of the GP: a quantity that was measured at the points.
struct FitOutput {
  const VectorView targets;  ///< n; metres for heights, no unit for labels
  double& signal;            ///< standard deviation of the prior, unit of the targets
  double& mean;              ///< prior mean, unit of the targets
};

/// Data and hyperparameters of a fit. The model of output i is
///     targets_i ~ N(mean_i, signal_i^2 (k + mean_ratio^2 + noise_ratio^2 I)).
/// So the outputs of a fit share the kernel k, the ratio of noise to signal, and one factorisation.
struct FitProblem {
  const PointsView points;  ///< n x 2, metres; n >= 1
  Kernel& kernel;           ///< its hyperparameters may be changed
  double& noise_ratio;      ///< standard deviation of the noise of one tap, divided by the signal
  const double mean_ratio;  ///< standard deviation of an unknown constant added to the mean, over the signal; >= 0
  std::vector<FitOutput> outputs;  ///< one, or several that share their hyperparameters
  /// Numbers that a fit of this GP stores for the next fit of the same GP; the framework does not read them. Empty
  /// before the first fit; null if no other fit follows. A resumed run repeats all fits, beginning with the first.
  std::vector<double>* memory = nullptr;
};

/// Result of a fit.
struct FitSummary {
  bool changed = false;    ///< whether the hyperparameters changed; otherwise they are exactly the old ones
  bool failed = false;     ///< whether the fit found no finite values; never with `changed`
  double objective = 0.0;  ///< final value of the fit's objective; larger is better
  int evaluations = 0;     ///< number of evaluations of the objective
  std::string reason;      ///< reason for the end, one line
};

/// Law: never throws for numerical reasons. A failed fit keeps the old hyperparameters, and returns `changed` false,
/// `failed` true and the reason.
class Fitting {
 public:
  static constexpr const char* kKind = "fitting";

  virtual ~Fitting() = default;

  /// Returns whether a GP with `taps` contacts is due for a fit. A pure function, so that a resumed run fits at the
  /// same taps.
  virtual bool due(int taps) const = 0;

  /// Returns the reason why this fitting cannot work with the kernel, one line; empty if it can. Called once, before
  /// the first tap.
  virtual std::string objection(const Kernel& kernel) const;

  /// Fits the hyperparameters in place. `random` is the stream of this GP at this tap.
  virtual FitSummary fit(FitProblem& problem, Random& random) const = 0;
};

inline std::string Fitting::objection(const Kernel&) const { return {}; }

}  // namespace palpate
