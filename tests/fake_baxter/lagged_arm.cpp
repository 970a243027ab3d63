// SPDX-License-Identifier: MIT
#include "fake_baxter/lagged_arm.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace palpate::fake_baxter {

LaggedArm::LaggedArm(const SceneFrame& scene_frame, const Eigen::Vector3d& tip)
    : scene_frame_(scene_frame),
      dynamics_(tip),
      lag_(joint_lag(scene_frame.scene())),
      object_give_(1.0 / object_stiffness(scene_frame.scene())) {
  const Effects& effects = scene_frame.scene().effects();
  arm_give_ = effects.stiffness && effects.stiffness->arm ? 1.0 / *effects.stiffness->arm : 0.0;
  put(Joints::Zero());
}

void LaggedArm::put(const Joints& joints) {
  unloaded_ = joints;
  brake();
  touch();
  state_.velocity.setZero();
}

void LaggedArm::brake() {
  joints_.clear();
  for (double one : unloaded_) joints_.emplace_back(lag_, kPeriod, one);
}

void LaggedArm::advance(const Joints& reference) {
  const Joints before = state_.position;
  for (int i = 0; i < 7; ++i) {
    backends::SimulatedAxis& joint = joints_[static_cast<std::size_t>(i)];
    joint.follow(reference(i));
    unloaded_(i) = joint.position();
  }
  touch();
  state_.velocity = (state_.position - before) / kPeriod;
}

/// Computes position and forces of the tip under contact.
void LaggedArm::touch() {
  const double pressed = std::max(0.0, -scene_frame_.clearance(dynamics_.tip(unloaded_)));
  state_.pressing = pressed / (object_give_ + arm_give_);
  state_.peak = state_.pressing;
  state_.depth = object_give_ * state_.pressing;
  state_.position = unloaded_;
  state_.felt = {0.0, 0.0, state_.pressing};
  state_.effort.setZero();
  if (!(state_.pressing > 0.0)) return;
  const Eigen::Matrix<double, 3, 7> jacobian = dynamics_.jacobian(unloaded_).topRows<3>();
  state_.effort = -jacobian.transpose() * state_.felt;
  if (!(arm_give_ > 0.0)) return;
  const Eigen::Matrix3d square = jacobian * jacobian.transpose();
  state_.position += jacobian.transpose() * (square.inverse() * (arm_give_ * state_.felt));
}

}  // namespace palpate::fake_baxter
