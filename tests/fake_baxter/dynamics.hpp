// SPDX-License-Identifier: MIT
// Rigid-body dynamics of the left arm, by KDL.
#pragma once

#include "baxter/robot.hpp"

#include <memory>

namespace palpate::fake_baxter {

using baxter::Joints;

/// `tip`: position of the tool's tip in the frame left_hand, metres. Not thread-safe, because the solvers have internal
/// state.
class Dynamics {
 public:
  explicit Dynamics(const Eigen::Vector3d& tip);
  ~Dynamics();
  Dynamics(Dynamics&&) noexcept;
  Dynamics& operator=(Dynamics&&) noexcept;

  using Inertia = Eigen::Matrix<double, 7, 7>;
  using Jacobian = Eigen::Matrix<double, 6, 7>;

  /// Returns the joint torques that hold the arm at rest, Nm.
  Joints weight(const Joints& joints) const;
  /// Returns the inertia matrix, kg m^2.
  Inertia inertia(const Joints& joints) const;
  /// Returns the joint accelerations under these torques and gravity, rad/s^2.
  Joints acceleration(const Joints& joints, const Joints& speed, const Joints& torques) const;
  /// Returns the Jacobian of the tip in `base`: rows in m/rad, then rad/rad.
  Jacobian jacobian(const Joints& joints) const;
  /// Returns the position of the tip in `base`, metres.
  Eigen::Vector3d tip(const Joints& joints) const;

 private:
  struct Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace palpate::fake_baxter
