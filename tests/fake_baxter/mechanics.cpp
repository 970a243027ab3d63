// SPDX-License-Identifier: MIT
#include "fake_baxter/mechanics.hpp"

#include "fake_baxter/lagged.hpp"
#include "fake_baxter/mujoco.hpp"
#include "fake_baxter/springs.hpp"

namespace palpate::fake_baxter {

double Ground::clearance(const Eigen::Vector3d& in_base) const {
  const Eigen::Vector3d at = in_scene(in_base);
  return at.z() - scene_.height(at.x(), at.y());
}

JointLag joint_lag(const Scene& scene) { return scene.effects().joint_lag.value_or(JointLag{Mechanics::kLag, 0.0}); }

double object_stiffness(const Scene& scene) {
  constexpr double kSoft = 1500.0;
  return scene.effects().stiffness ? scene.effects().stiffness->object : kSoft;
}

std::unique_ptr<Mechanics> make_mechanics(const MechanicsOptions& options, const Ground& ground,
                                          const Eigen::Vector3d& tip) {
  switch (options.type) {
    case MechanicsOptions::Type::springs:
      return std::make_unique<Springs>(ground, tip, options.friction, options.step);
    case MechanicsOptions::Type::mujoco:
      return make_mujoco(ground, tip, options.friction);
    default:
      return std::make_unique<Lagged>(ground, tip);
  }
}

}  // namespace palpate::fake_baxter
