// SPDX-License-Identifier: MIT
// The mechanics of the arm of the tests' robot: what its joints do in one period when the firmware has them follow a
// reference, and what that presses on. What the firmware decides is the body's.
#pragma once

#include "baxter/kinematics.hpp"
#include "baxter/options.hpp"

#include <palpate/scene.hpp>

#include <memory>
#include <string>

namespace palpate::fake_baxter {

using baxter::Joints;

/// What there is to press on: a scene where `scene_pose` puts it before the robot. Keeps a reference to the scene.
class Ground {
 public:
  Ground(const Scene& scene, const baxter::ScenePoseOptions& place) : scene_(scene), frame_(place.frame()) {}

  const Scene& scene() const { return scene_; }
  /// A place in the robot's frame `base` as one of the scene, metres; and back.
  Eigen::Vector3d in_scene(const Eigen::Vector3d& in_base) const { return frame_.inverse() * in_base; }
  Eigen::Vector3d in_base(const Eigen::Vector3d& in_scene) const { return frame_ * in_scene; }
  /// How far a place of `base` is above what lies there, metres; negative below it.
  double clearance(const Eigen::Vector3d& in_base) const;

 private:
  const Scene& scene_;
  Eigen::Isometry3d frame_;
};

/// How the joints trail their references: scene.effects.joint_lag, 0.35 s if absent.
JointLag joint_lag(const Scene& scene);
/// Of what the tip presses on, N/m: scene.effects.stiffness.object, 1500 if absent.
double object_stiffness(const Scene& scene);

/// What an instrumented arm would show at the end of a period.
struct ArmState {
  Joints position = Joints::Zero();  ///< rad, with what the arm gives way
  Joints velocity = Joints::Zero();  ///< rad/s
  Joints effort = Joints::Zero();    ///< torques that carry the arm and press, Nm
  double pressing = 0.0;             ///< N, upwards on the tip: the truth
  double peak = 0.0;                 ///< N, the most that it was during the period
  double depth = 0.0;                ///< m, the most by which the tip was below what it presses during the period
  /// N in `base`, on the tip: what the robot makes of its efforts, before noise and bias.
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();
};

/// An arm. The firmware's position loop belongs to it: every joint trails its reference by a lag.
class Mechanics {
 public:
  static constexpr double kPeriod = 0.01;  ///< s
  static constexpr double kLag = 0.35;     ///< s

  virtual ~Mechanics() = default;

  /// Stands there at once, at rest, under what it presses on.
  virtual void put(const Joints& joints) = 0;
  /// One period with this reference.
  virtual void advance(const Joints& reference) = 0;
  /// The reference that keeps the arm as it is, with the force that it presses with.
  virtual Joints holding() const = 0;
  /// The brakes close: with the reference `holding()` it stands at once.
  virtual void brake() = 0;

  const ArmState& state() const { return state_; }

 protected:
  ArmState state_;
};

/// Which arm.
struct MechanicsOptions {
  enum class Type {
    lagged,   ///< joints that trail their reference, without mass: lagged.hpp
    springs,  ///< rigid bodies and springs, by KDL: springs.hpp
    mujoco    ///< the same arm, by MuJoCo: mujoco.hpp
  };
  Type type = Type::lagged;
  double friction = 0.0;  ///< of every joint, Nm; lagged has none
  double step = 1e-3;     ///< of springs, s, which goes into a period
};

/// The arm with a tool whose tip is there in the frame left_hand, metres, over `ground`, which it keeps; the effects of
/// the scene say how stiff what it presses on is and how the joints lag. Throws Error for an arm that this build does
/// not have.
std::unique_ptr<Mechanics> make_mechanics(const MechanicsOptions& options, const Ground& ground,
                                          const Eigen::Vector3d& tip);

}  // namespace palpate::fake_baxter
