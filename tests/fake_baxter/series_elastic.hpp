// SPDX-License-Identifier: MIT
// Common part of the arms with mass: motors that follow the reference with the firmware's lag, springs between motors
// and joints, and the robot's force estimate from the torques of the springs.
#pragma once

#include "fake_baxter/mechanics.hpp"
#include "simulator/arm.hpp"

#include <vector>

namespace palpate::fake_baxter {

/// Stiffness of the springs, Nm/rad, larger in shoulder and elbow than in the wrist.
const Joints& spring_stiffness();
/// Damping of the springs by the firmware, Nm s/rad.
const Joints& spring_damping();
/// Damping of the joints' bearings, Nm s/rad, from baxter.urdf.
constexpr double kBearings = 0.7;
/// Fraction of the weight that the firmware does not compensate: the arm settles 0.004 to 0.008 rad off its reference.
constexpr double kSag = 0.15;
/// Relaxation time of the contact, s: its damping is its stiffness times this.
constexpr double kRelaxation = 1e-3;

/// Positions of the motors: the joint positions without load.
class Motors {
 public:
  /// `step`: duration of a reference, s.
  Motors(const JointLag& lag, double step) : lag_(lag), step_(step) {}

  /// Moves the motors to `joints` at once, at rest.
  void put(const Joints& joints);
  void follow(const Joints& reference);

  const Joints& position() const { return position_; }  ///< rad
  const Joints& velocity() const { return velocity_; }  ///< rad/s

  /// Returns the torques of the springs, Nm, for these joints (rad, rad/s) and the known weight (Nm).
  Joints torque(const Joints& joints, const Joints& speed, const Joints& weight) const;

 private:
  JointLag lag_;
  double step_;
  std::vector<backends::SimulatedAxis> each_;
  Joints position_ = Joints::Zero();
  Joints velocity_ = Joints::Zero();
};

/// Returns the force on the tip (N, in `base`) that fits the torques beyond the weight (Nm) best. `jacobian` is that of
/// the tip, m/rad and rad/rad. Damping keeps the result finite near singular postures.
Eigen::Vector3d estimate_force(const Eigen::Matrix<double, 6, 7>& jacobian, const Joints& torques);

}  // namespace palpate::fake_baxter
