// SPDX-License-Identifier: MIT
// Arm without mass: every joint follows its reference with a lag, and contacts are springs.
#pragma once

#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/mechanics.hpp"
#include "simulator/arm.hpp"

#include <vector>

namespace palpate::fake_baxter {

/// The lag is scene.effects.joint_lag, default 0.35 s. The scene below the tip is a spring
/// (scene.effects.stiffness.object, default 1500 N/m). With stiffness.arm the joints deflect, too. The measured force
/// is exact.
class LaggedArm final : public Mechanics {
 public:
  LaggedArm(const SceneFrame& scene_frame, const Eigen::Vector3d& tip);

  void put(const Joints& joints) override;
  void advance(const Joints& reference) override;
  Joints holding() const override { return unloaded_; }
  void brake() override;

 private:
  void touch();

  SceneFrame scene_frame_;
  Dynamics dynamics_;
  JointLag lag_;
  double object_give_;  ///< m/N
  double arm_give_;     ///< m/N
  std::vector<backends::SimulatedAxis> joints_;
  Joints unloaded_;  ///< joints without deflection
};

}  // namespace palpate::fake_baxter
