// SPDX-License-Identifier: MIT
// An arm without mass: every joint follows its reference with a lag, and what it presses on is a spring.
#pragma once

#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/mechanics.hpp"
#include "simulator/arm.hpp"

#include <vector>

namespace palpate::fake_baxter {

/// The lag is scene.effects.joint_lag, 0.35 s if absent. The tip presses on whatever the scene has below it as on a
/// spring (scene.effects.stiffness.object, 1500 N/m if absent); if the arm gives way, too (stiffness.arm), the joints
/// show it. What it feels is that force, exactly.
class Lagged final : public Mechanics {
 public:
  Lagged(const Ground& ground, const Eigen::Vector3d& tip);

  void put(const Joints& joints) override;
  void advance(const Joints& reference) override;
  Joints holding() const override { return unloaded_; }
  void brake() override;

 private:
  void touch();

  Ground ground_;
  Dynamics dynamics_;
  JointLag lag_;
  double object_give_;  ///< m/N
  double arm_give_;     ///< m/N
  std::vector<backends::Arm> joints_;
  Joints unloaded_;  ///< where the joints would be if the arm did not give way
};

}  // namespace palpate::fake_baxter
