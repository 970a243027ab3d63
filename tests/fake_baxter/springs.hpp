// SPDX-License-Identifier: MIT
// An arm of rigid bodies with springs in its joints, as Baxter's is, moved by KDL's solvers.
#pragma once

#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/series_elastic.hpp"

namespace palpate::fake_baxter {

/// The tip presses on whatever the scene has below it as on a damped spring, vertically and without friction; the arm
/// gives way by its own springs. What it feels comes from their torques, with all that is not a force in it: friction
/// of the joints, and masses that are moved.
///
/// A step is semi-implicit: springs push from where things were, damping and friction act on the speed that they lead
/// to. Joints stick, and the tip leaves the ground, exactly: a small complementarity problem in every step.
class Springs final : public Mechanics {
 public:
  /// `step`: s, which goes into a period; `friction`: of every joint, Nm.
  Springs(const Ground& ground, const Eigen::Vector3d& tip, double friction, double step);

  void put(const Joints& joints) override;
  void advance(const Joints& reference) override;
  Joints holding() const override { return motors_.position(); }
  void brake() override { motors_.put(motors_.position()); }

 private:
  void step(const Joints& reference);
  void measure();

  Ground ground_;
  Dynamics dynamics_;
  Motors motors_;
  double stiffness_;                 ///< of what is pressed, N/m
  double friction_;                  ///< Nm
  double step_;                      ///< s
  int steps_;                        ///< in a period
  Joints rubbing_ = Joints::Zero();  ///< torques of friction, Nm: where the next step begins to look for its own
};

}  // namespace palpate::fake_baxter
