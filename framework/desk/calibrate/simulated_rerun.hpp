// SPDX-License-Identifier: MIT
// The recorded taps of a run, made again by the simulator: what its arm adds to their heights, and how often they fail.
#pragma once

#include "record/recording.hpp"

#include <vector>

namespace palpate {

class SimulatedRerun {
 public:
  /// `workshop` and `recording` must outlive it. Throws Error for a run whose backend has no `motion`, and for what the
  /// simulator refuses.
  SimulatedRerun(const Workshop& workshop, const Recording& recording);

  /// What became of the taps over some draws of the effects.
  struct Result {
    std::vector<double> error;     ///< of each tap: median of height less that of the scene there; 0 without a contact
    std::vector<double> variance;  ///< of it, square metres, by the median deviation
    double failed = 0.0;           ///< share of the taps
    double far_off = 0.0;          ///< share of the contacts that are kFarOff from what is expected
    double mean_error = 0.0;       ///< of all that are not
  };
  /// `effects`: as `scene.effects` has them; the same draws for all. `expected`: what each tap is thought to be off;
  /// its median where it is empty.
  Result make(const Tree& effects, const std::vector<double>& expected = {}) const;

  static constexpr double kFarOff = 0.01;  ///< metres

 private:
  const Workshop& workshop_;
  const Recording& recording_;
  Tree config_;
};

/// The taps of a recording as they were asked for.
std::vector<TapRequest> requests_of(const Recording& recording);

}  // namespace palpate
