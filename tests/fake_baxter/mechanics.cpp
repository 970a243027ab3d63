// SPDX-License-Identifier: MIT
#include "fake_baxter/mechanics.hpp"

#include "fake_baxter/lagged_arm.hpp"
#include "fake_baxter/mujoco_arm.hpp"
#include "fake_baxter/spring_arm.hpp"

namespace palpate::fake_baxter {

double SceneFrame::clearance(const Eigen::Vector3d& in_base) const {
  const Eigen::Vector3d at = in_scene(in_base);
  return at.z() - scene_.height(at.x(), at.y());
}

JointLag joint_lag(const Scene& scene) { return scene.effects().joint_lag.value_or(JointLag{Mechanics::kLag, 0.0}); }

double object_stiffness(const Scene& scene) {
  constexpr double kSoft = 1500.0;
  return scene.effects().stiffness ? scene.effects().stiffness->object : kSoft;
}

std::unique_ptr<Mechanics> make_mechanics(const MechanicsOptions& options, const SceneFrame& scene_frame,
                                          const Eigen::Vector3d& tip) {
  switch (options.type) {
    case MechanicsOptions::Type::springs:
      return std::make_unique<SpringArm>(scene_frame, tip, options.friction, options.step);
    case MechanicsOptions::Type::mujoco:
      return make_mujoco(scene_frame, tip, options.friction);
    default:
      return std::make_unique<LaggedArm>(scene_frame, tip);
  }
}

}  // namespace palpate::fake_baxter
