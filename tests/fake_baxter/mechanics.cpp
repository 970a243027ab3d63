// SPDX-License-Identifier: MIT
#include "fake_baxter/mechanics.hpp"

#include "fake_baxter/lagged.hpp"
#include "fake_baxter/mujoco.hpp"
#include "fake_baxter/springs.hpp"

#include <palpate/error.hpp>

namespace palpate::fake_baxter {

Eigen::Vector3d Ground::in_scene(const Eigen::Vector3d& in_base) const {
  const Eigen::Rotation2Dd back(-place_.rotation);
  Eigen::Vector3d out;
  out << back * (in_base.head<2>() - Eigen::Vector2d(place_.corner)), in_base.z() - place_.height;
  return out;
}

Eigen::Vector3d Ground::in_base(const Eigen::Vector3d& in_scene) const {
  const Eigen::Rotation2Dd turn(place_.rotation);
  Eigen::Vector3d out;
  out << Eigen::Vector2d(place_.corner) + turn * in_scene.head<2>(), place_.height + in_scene.z();
  return out;
}

double Ground::clearance(const Eigen::Vector3d& in_base) const {
  const Eigen::Vector3d at = in_scene(in_base);
  return at.z() - scene_.height(at.x(), at.y());
}

JointLag joint_lag(const Scene& scene) { return scene.effects().joint_lag.value_or(JointLag{Mechanics::kLag, 0.0}); }

double object_stiffness(const Scene& scene) {
  constexpr double kSoft = 1500.0;
  return scene.effects().stiffness ? scene.effects().stiffness->object : kSoft;
}

MechanicsOptions::Type parse_mechanics(const std::string& word) {
  if (word == "lagged") return MechanicsOptions::Type::lagged;
  if (word == "springs") return MechanicsOptions::Type::springs;
  if (word == "mujoco") return MechanicsOptions::Type::mujoco;
  throw Error("--arm", "takes lagged, springs or mujoco, not '" + word + "'");
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
