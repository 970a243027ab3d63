// SPDX-License-Identifier: MIT
// Mechanics of the simulated arm: motion of the joints in one period under the firmware's position control, and contact
// forces. Decisions of the firmware are in body.hpp.
#pragma once

#include "baxter/kinematics.hpp"
#include "baxter/options.hpp"

#include <palpate/scene.hpp>

#include <memory>
#include <string>

namespace palpate::fake_baxter {

using baxter::Joints;

/// A scene at its pose `scene_pose` in the robot's frame. Keeps a reference to the scene.
class SceneFrame {
 public:
  SceneFrame(const Scene& scene, const baxter::ScenePoseOptions& place) : scene_(scene), frame_(place.frame()) {}

  const Scene& scene() const { return scene_; }
  /// Convert a position between the robot's frame `base` and the scene's frame, metres.
  Eigen::Vector3d in_scene(const Eigen::Vector3d& in_base) const { return frame_.inverse() * in_base; }
  Eigen::Vector3d in_base(const Eigen::Vector3d& in_scene) const { return frame_ * in_scene; }
  /// Returns the height of a position in `base` above the scene, metres; negative below its surface.
  double clearance(const Eigen::Vector3d& in_base) const;

 private:
  const Scene& scene_;
  Eigen::Isometry3d frame_;
};

/// Returns the lag of the joints behind their references: scene.effects.joint_lag, default 0.35 s.
JointLag joint_lag(const Scene& scene);
/// Returns the stiffness of the contact, N/m: scene.effects.stiffness.object, default 1500.
double object_stiffness(const Scene& scene);

/// True state of the arm at the end of a period.
struct ArmState {
  Joints position = Joints::Zero();  ///< rad, including deflection
  Joints velocity = Joints::Zero();  ///< rad/s
  Joints effort = Joints::Zero();    ///< Nm, including gravity and contact
  double pressing = 0.0;             ///< N, true upward force on the tip
  double peak = 0.0;                 ///< N, largest force during the period
  double depth = 0.0;                ///< m, largest depth of the tip below the undeformed surface during the period
  /// Force on the tip in N, in `base`, as the robot estimates it from its torques, before noise and bias.
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();
};

/// Model of an arm including the firmware's position control: every joint follows its reference with a lag.
class Mechanics {
 public:
  static constexpr double kPeriod = 0.01;  ///< s
  static constexpr double kLag = 0.35;     ///< s

  virtual ~Mechanics() = default;

  /// Moves the arm to `joints` at once, at rest, with the contact force there.
  virtual void put(const Joints& joints) = 0;
  /// Simulates one period with this reference.
  virtual void advance(const Joints& reference) = 0;
  /// Returns the reference that keeps the present position and contact force.
  virtual Joints holding() const = 0;
  /// Closes the brakes: with the reference `holding()` the arm stops at once.
  virtual void brake() = 0;

  const ArmState& state() const { return state_; }

 protected:
  ArmState state_;
};

/// Selects the model of the arm.
struct MechanicsOptions {
  enum class Type {
    lagged,   ///< joints with lag, without mass: lagged_arm.hpp
    springs,  ///< rigid bodies and springs, by KDL: spring_arm.hpp
    mujoco    ///< the same arm, by MuJoCo: mujoco_arm.hpp
  };
  Type type = Type::lagged;
  double friction = 0.0;  ///< Nm per joint; unused by `lagged`
  double step = 1e-3;     ///< s, step of `springs`; must divide the period
};

/// Creates the model of the arm. `tip`: position of the tool's tip in the frame left_hand, metres.
/// tapping::HeightResult stiffness and lag come from the effects of the scene in `scene_frame`, of which the model
/// keeps a copy. Throws Error if this build does not have the model.
std::unique_ptr<Mechanics> make_mechanics(const MechanicsOptions& options, const SceneFrame& scene_frame,
                                          const Eigen::Vector3d& tip);

}  // namespace palpate::fake_baxter
