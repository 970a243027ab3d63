// SPDX-License-Identifier: MIT
// Simulation of a run's recorded taps: the errors of their heights, and the share of failures.
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
    std::vector<double> error;     ///< per tap: median error of the height, metres; 0 without a contact
    std::vector<double> variance;  ///< per tap: variance of the error by the median absolute deviation, square metres
    double failed = 0.0;           ///< share of the taps
    double far_off = 0.0;     ///< share of the contacts whose error differs from `expected` by more than kOutlierError
    double mean_error = 0.0;  ///< mean error of the other contacts
  };
  /// Simulates the taps with `effects`, in the format of `scene.effects`; every call uses the same draws. `expected`
  /// has the expected error of each tap, by default its median.
  Result make(const Tree& effects, const std::vector<double>& expected = {}) const;

  static constexpr double kOutlierError = 0.01;  ///< metres

 private:
  const RunEnvironment& environment_;
  const RecordedRun& recording_;
  Tree config_;
};

/// Returns the requests of a recording's taps.
std::vector<TapRequest> requests_of(const RecordedRun& recording);

}  // namespace palpate
