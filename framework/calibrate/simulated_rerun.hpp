// SPDX-License-Identifier: MIT
// Simulation of a run's recorded taps, to obtain the errors of the heights and the share of failed taps.
#pragma once

#include "record/run_replay.hpp"

#include <vector>

namespace palpate {

class SimulatedRerun {
 public:
  /// `environment` and `recording` must outlive the object. Throws Error for a run whose backend has no `motion`, and
  /// for a config that the simulator rejects.
  SimulatedRerun(const RunEnvironment& environment, const RecordedRun& recording);

  /// Errors of the taps over several draws of the effects.
  struct Result {
    std::vector<double> error;  ///< median error of the height of each tap, metres; 0 for taps without a contact
    /// variance of the error of each tap over the draws, from the median absolute deviation, square metres
    std::vector<double> variance;
    double failed = 0.0;  ///< share of taps without a contact, except unreachable taps
    /// share of the contacts whose error differs from the expected error by more than kOutlierError
    double far_off = 0.0;
    double mean_error = 0.0;  ///< mean error of the contacts that `far_off` does not count, metres
  };
  /// Simulates the taps with `effects`, which have the format of `scene.effects`. Every call uses the same random
  /// draws. `expected`: expected error of each tap, metres; by default, the median error of the tap over the draws.
  Result make(const Tree& effects, const std::vector<double>& expected = {}) const;

  static constexpr double kOutlierError = 0.01;  ///< metres

 private:
  const RunEnvironment& environment_;
  const RecordedRun& recording_;
  Tree config_;
};

/// Returns the tap requests of a recorded run.
std::vector<TapRequest> requests_of(const RecordedRun& recording);

}  // namespace palpate
