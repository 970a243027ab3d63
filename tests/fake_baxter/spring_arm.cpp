// SPDX-License-Identifier: MIT
#include "fake_baxter/spring_arm.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace palpate::fake_baxter {
namespace {

constexpr int kSweeps = 200;       // iterations of the solver for friction and contact
constexpr double kSettled = 1e-9;  // rad/s, change of a speed at which the iteration ends

}  // namespace

SpringArm::SpringArm(const SceneFrame& scene_frame, const Eigen::Vector3d& tip, double friction, double step)
    : scene_frame_(scene_frame),
      dynamics_(tip),
      motors_(joint_lag(scene_frame.scene()), step),
      stiffness_(object_stiffness(scene_frame.scene())),
      friction_(friction),
      step_(step),
      steps_(static_cast<int>(std::lround(kPeriod / step))) {}

void SpringArm::put(const Joints& joints) {
  state_ = {};
  state_.position = joints;
  state_.depth = std::max(0.0, -scene_frame_.clearance(dynamics_.tip(joints)));
  state_.pressing = stiffness_ * state_.depth;
  // Position of the motors at which the springs carry the uncompensated weight minus the contact force.
  const Joints carried = dynamics_.jacobian(joints).row(2).transpose() * state_.pressing;
  const Joints left = kSag * dynamics_.weight(joints) - carried;
  motors_.put(joints + left.cwiseQuotient(spring_stiffness()));
  rubbing_.setZero();
  state_.effort = motors_.torque(joints, Joints::Zero(), dynamics_.weight(joints));
  state_.peak = state_.pressing;
  measure();
}

void SpringArm::advance(const Joints& reference) {
  state_.peak = 0.0;
  state_.depth = 0.0;
  for (int i = 0; i < steps_; ++i) step(reference);
  measure();
}

/// Solves M (v' - v) / h = M a - B (v' - v) / 2 + J_z f + r for the new speed v'. a is the acceleration by springs and
/// weight at the present position, and by the dampers B at the speed v; the step uses the mean of both speeds. f is the
/// contact force, f = max(0, k d - c (w + w') / 2), with depth d and speed w of the tip. r is friction within its
/// bounds, and v' = 0 where it is strictly inside. The solver is projected Gauss-Seidel.
void SpringArm::step(const Joints& reference) {
  Joints& position = state_.position;
  Joints& speed = state_.velocity;
  motors_.follow(reference);
  const Joints weight = dynamics_.weight(position);
  const Joints torque = motors_.torque(position, speed, weight);
  Dynamics::Inertia inertia = dynamics_.inertia(position);
  const Joints push = inertia * dynamics_.acceleration(position, speed, torque - kBearings * speed);
  inertia.diagonal() += step_ / 2 * (spring_damping() + Joints::Constant(kBearings));
  const Dynamics::Inertia mobility = inertia.llt().solve(Dynamics::Inertia::Identity());

  const Joints lever = dynamics_.jacobian(position).row(2).transpose();
  const Joints lifted = step_ * (mobility * lever);  // m/s per newton
  const double raised = lever.dot(lifted);
  const double depth = -scene_frame_.clearance(dynamics_.tip(position));
  const double damping = kRelaxation * stiffness_ / 2;
  const double before_force = stiffness_ * depth - damping * lever.dot(speed);
  double force = depth > 0.0 ? state_.pressing : 0.0;
  Joints next = speed + step_ * (mobility * (push + rubbing_)) + lifted * force;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Joints before = next;
    if (depth > 0.0) {
      const double without = lever.dot(next) - raised * force;
      const double now = std::max(0.0, (before_force - damping * without) / (1.0 + damping * raised));
      next += (now - force) * lifted;
      force = now;
    }
    for (int i = 0; i < 7 && friction_ > 0.0; ++i) {
      const double now = std::clamp(rubbing_(i) - next(i) / (step_ * mobility(i, i)), -friction_, friction_);
      next += step_ * (now - rubbing_(i)) * mobility.col(i);
      rubbing_(i) = now;
    }
    if ((next - before).cwiseAbs().maxCoeff() < kSettled) break;
  }
  state_.effort = motors_.torque(position, (speed + next) / 2, weight);
  speed = next;
  position += step_ * speed;
  state_.pressing = force;
  state_.peak = std::max(state_.peak, force);
  state_.depth = std::max(state_.depth, depth);
}

/// The robot subtracts the weight of its arm, and interprets all other torques of its springs as a force on the tip.
void SpringArm::measure() {
  const Joints weight = dynamics_.weight(state_.position);
  state_.felt = estimate_force(dynamics_.jacobian(state_.position), weight - state_.effort);
}

}  // namespace palpate::fake_baxter
