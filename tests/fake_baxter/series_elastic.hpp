// SPDX-License-Identifier: MIT
// What the arms with masses have in common, whoever computes how the masses move: motors that follow the reference with
// the firmware's lag, springs between motors and joints, and what the robot makes of the springs' torques.
#pragma once

#include "fake_baxter/mechanics.hpp"
#include "simulator/arm.hpp"

#include <vector>

namespace palpate::fake_baxter {

/// Of the springs, Nm/rad: stiff ones in shoulder and elbow, softer ones in the wrist.
const Joints& spring_stiffness();
/// By which the firmware damps them, Nm s/rad.
const Joints& spring_damping();
/// Of the joints' bearings, Nm s/rad, as baxter.urdf has it.
constexpr double kBearings = 0.7;
/// The part of its weight that the firmware does not make up for: the arm settles 0.004 to 0.008 rad off its reference.
constexpr double kSag = 0.15;
/// How long what is pressed takes to follow, s: its damping is its stiffness times this.
constexpr double kRelaxation = 1e-3;

/// What the motors do: where they would have the joints if these carried no load.
class Motors {
 public:
  /// `step`: for how long a reference stays, s.
  Motors(const JointLag& lag, double step) : lag_(lag), step_(step) {}

  /// At rest there.
  void put(const Joints& joints);
  void follow(const Joints& reference);

  const Joints& position() const { return position_; }  ///< rad
  const Joints& velocity() const { return velocity_; }  ///< rad/s

  /// Torques of the springs, Nm, with the joints there (rad, rad/s) and a weight (Nm) that the firmware knows.
  Joints torque(const Joints& joints, const Joints& speed, const Joints& weight) const;

 private:
  JointLag lag_;
  double step_;
  std::vector<backends::Arm> each_;
  Joints position_ = Joints::Zero();
  Joints velocity_ = Joints::Zero();
};

/// The force on the tip (N, in `base`) that explains torques beyond the weight (Nm) best; `jacobian`: of the tip, m/rad
/// and rad/rad. Damped: near a singular posture it stays finite.
Eigen::Vector3d estimate_force(const Eigen::Matrix<double, 6, 7>& jacobian, const Joints& torques);

}  // namespace palpate::fake_baxter
