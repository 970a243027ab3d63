// SPDX-License-Identifier: MIT
// Arm of rigid bodies with springs in its joints, as in Baxter, by KDL's solvers.
#pragma once

#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/series_elastic.hpp"

namespace palpate::fake_baxter {

/// The scene below the tip is a vertical damped spring without friction; the arm deflects in its own springs. The
/// measured force comes from their torques, including the effects of joint friction and of accelerated masses.
///
/// The step is semi-implicit: springs act at the old position, damping and friction at the new speed. Sticking of
/// joints and loss of contact are exact, by a small complementarity problem per step.
class SpringArm final : public Mechanics {
 public:
  /// `step`: s, must divide the period; `friction`: of every joint, Nm.
  SpringArm(const SceneFrame& scene_frame, const Eigen::Vector3d& tip, double friction, double step);

  void put(const Joints& joints) override;
  void advance(const Joints& reference) override;
  Joints holding() const override { return motors_.position(); }
  void brake() override { motors_.put(motors_.position()); }

 private:
  void step(const Joints& reference);
  void measure();

  SceneFrame scene_frame_;
  Dynamics dynamics_;
  Motors motors_;
  double stiffness_;                 ///< N/m, contact
  double friction_;                  ///< Nm
  double step_;                      ///< s
  int steps_;                        ///< steps per period
  Joints rubbing_ = Joints::Zero();  ///< Nm, friction of the last step, start of the next iteration
};

}  // namespace palpate::fake_baxter
