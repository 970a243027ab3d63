// SPDX-License-Identifier: MIT
#include "fake_baxter/force_faults.hpp"

#include <algorithm>
#include <limits>

namespace palpate::fake_baxter {

Eigen::Vector3d ForceFaults::spoilt(Eigen::Vector3d force, const Eigen::Vector3d& tip_speed, const Active& active) {
  if (const Fault* bias = active(FaultKind::bias)) force.z() -= bias->amount;
  if (const Fault* spikes = active(FaultKind::spikes)) {
    if (random_.uniform() < spikes->amount) force.z() -= kSpike;
  }
  if (const Fault* moving = active(FaultKind::moving_force)) {
    // Friction in the joints: an arm on its way down feels as though something pressed it upwards.
    const Eigen::Vector3d way = tip_speed / std::max(kMoving, tip_speed.norm());
    force += moving->amount * (way + way.z() * Eigen::Vector3d(kAside[0], kAside[1], 0.0));
  }
  if (active(FaultKind::zero_wrench) != nullptr) force.setZero();
  if (active(FaultKind::nan_wrench) != nullptr) force.setConstant(std::numeric_limits<double>::quiet_NaN());
  return force;
}

}  // namespace palpate::fake_baxter
