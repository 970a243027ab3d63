// SPDX-License-Identifier: MIT
// What faults make of the force that the robot estimates.
#pragma once

#include "fake_baxter/faults.hpp"

#include <palpate/random.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <functional>

namespace palpate::fake_baxter {

class ForceFaults {
 public:
  static constexpr double kSpike = 9.0;            ///< N
  static constexpr double kMoving = 0.01;          ///< m/s from which the force of a motion is at its full
  static constexpr double kAside[] = {0.5, -0.3};  ///< share of it along x and y that comes with motion along z

  /// Spikes come from `seed`.
  explicit ForceFaults(std::uint64_t seed) : random_(seed, "fake_baxter/spikes") {}

  /// The fault of a kind if it has begun, else null.
  using Active = std::function<const Fault*(FaultKind)>;
  /// The force of one reading (N, in `base`, negative along z when something presses the tool upwards) while the tip
  /// moves at this speed (m/s). To be called once a period.
  Eigen::Vector3d spoilt(Eigen::Vector3d force, const Eigen::Vector3d& tip_speed, const Active& active);

 private:
  Random random_;
};

}  // namespace palpate::fake_baxter
