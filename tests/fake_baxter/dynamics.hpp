// SPDX-License-Identifier: MIT
// The left arm as rigid bodies that KDL moves.
#pragma once

#include "baxter/robot.hpp"

#include <memory>

namespace palpate::fake_baxter {

using baxter::Joints;

/// With the tool's tip there in the frame left_hand, metres. Not to be shared: the solvers keep what they work with.
class Dynamics {
 public:
  explicit Dynamics(const Eigen::Vector3d& tip);
  ~Dynamics();
  Dynamics(Dynamics&&) noexcept;
  Dynamics& operator=(Dynamics&&) noexcept;

  using Inertia = Eigen::Matrix<double, 7, 7>;
  using Jacobian = Eigen::Matrix<double, 6, 7>;

  /// Torques that carry the arm at rest, Nm.
  Joints weight(const Joints& joints) const;
  /// kg m^2.
  Inertia inertia(const Joints& joints) const;
  /// With these torques on the joints, and nothing else but the weight, rad/s^2.
  Joints acceleration(const Joints& joints, const Joints& speed, const Joints& torques) const;
  /// Of the tip, in `base`: m/rad, then rad/rad.
  Jacobian jacobian(const Joints& joints) const;
  /// Where the tip is in `base`, metres.
  Eigen::Vector3d tip(const Joints& joints) const;

 private:
  struct Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace palpate::fake_baxter
