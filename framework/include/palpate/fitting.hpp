// SPDX-License-Identifier: MIT
// Plugin kind `fitting`: chooses the hyperparameters of a process from its taps.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/random.hpp>

#include <string>

namespace palpate {

/// What a fit may read and change. Targets are relative to the prior mean of the process.
struct FitProblem {
  const PointsView points;   ///< n x 2, metres; n >= 1
  const VectorView targets;  ///< n; metres for the height process, labels for the weight process
  Kernel& kernel;            ///< its hyperparameters may be changed
  double& signal;            ///< standard deviation of the prior, unit of the targets
  double& noise;             ///< standard deviation of the noise of one tap, unit of the targets
};

/// What a fit did, in numbers and words.
struct FitSummary {
  bool changed = false;    ///< the problem's hyperparameters are new; false leaves them exactly as they were
  double objective = 0.0;  ///< value reached, by the fit's own measure
  int evaluations = 0;     ///< of the objective
  std::string reason;      ///< why it ended, one line
};

/// Law: never throws for numerical reasons. A fit that fails restores the old hyperparameters, reports `changed`
/// false and says why.
class Fitting {
 public:
  static constexpr const char* kKind = "fitting";

  virtual ~Fitting() = default;

  /// Whether a process with `taps` contacts is due for a fit. A pure function, so that a resumed run fits at the
  /// same taps.
  virtual bool due(int taps) const = 0;

  /// Fits in place. `random` is the stream of this process at this tap.
  virtual FitSummary fit(FitProblem& problem, Random& random) const = 0;
};

}  // namespace palpate
