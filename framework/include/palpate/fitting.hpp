// SPDX-License-Identifier: MIT
// Plugin kind `fitting`: chooses the hyperparameters of a process from its taps.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/random.hpp>

#include <string>
#include <vector>

namespace palpate {

/// One quantity that was measured at the points.
struct FitOutput {
  const VectorView targets;  ///< n; metres for heights, no unit for labels
  double& signal;            ///< standard deviation of the prior, unit of the targets
  double& mean;              ///< prior mean, unit of the targets
};

/// What a fit may read and change. The model of output i is
///     targets_i ~ N(mean_i, signal_i^2 (k + mean_ratio^2 + noise_ratio^2 I)),
/// so outputs that are fitted together share the kernel and the ratio of noise to signal, and with them one
/// factorisation.
struct FitProblem {
  const PointsView points;  ///< n x 2, metres; n >= 1
  Kernel& kernel;           ///< its hyperparameters may be changed
  double& noise_ratio;      ///< standard deviation of the noise of one tap, in signals
  const double mean_ratio;  ///< standard deviation of the unknown constant that is added to the mean, in signals; >= 0
  std::vector<FitOutput> outputs;  ///< one, or several that share their hyperparameters
  /// What the fit of fewer taps of this process has left for this one, which may leave other numbers: nobody else reads
  /// them. Empty before the first fit; null where no other follows. A resumed run makes all fits again, from the first.
  std::vector<double>* memory = nullptr;
};

/// What a fit did, in numbers and words.
struct FitSummary {
  bool changed = false;    ///< the problem's hyperparameters are new; false leaves them exactly as they were
  bool failed = false;     ///< it was tried, but came to no finite values; never with `changed`
  double objective = 0.0;  ///< value reached, by the fit's own measure; larger is better
  int evaluations = 0;     ///< of the objective
  std::string reason;      ///< why it ended, one line
};

/// Law: never throws for numerical reasons. A fit that fails leaves the old hyperparameters, reports `changed` false
/// and `failed` true, and says why.
class Fitting {
 public:
  static constexpr const char* kKind = "fitting";

  virtual ~Fitting() = default;

  /// Whether a process with `taps` contacts is due for a fit. A pure function, so that a resumed run fits at the
  /// same taps.
  virtual bool due(int taps) const = 0;

  /// Why this fitting cannot work with such a kernel, one line; empty if it can. Asked once, before the first tap.
  virtual std::string objection(const Kernel& kernel) const;

  /// Fits in place. `random` is the stream of this process at this tap.
  virtual FitSummary fit(FitProblem& problem, Random& random) const = 0;
};

inline std::string Fitting::objection(const Kernel&) const { return {}; }

}  // namespace palpate
