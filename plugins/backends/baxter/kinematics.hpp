// SPDX-License-Identifier: MIT
// Baxter's left arm as a chain of seven joints. The numbers are those of Rethink's baxter.urdf 1.2.0; the solver is
// KDL's.
#pragma once

#include "baxter/robot.hpp"

#include <memory>
#include <optional>

namespace palpate::baxter {

/// The arm with something fixed to its flange (the frame `left_hand`). Safe to share; solve() is not.
class Arm {
 public:
  /// `tip`: the point of the tool that touches, in the frame left_hand, whose z axis goes on along the forearm; metres.
  explicit Arm(const Eigen::Vector3d& tip);
  ~Arm();

  /// Where the tip is, and how the hand is turned.
  Pose tip(const Joints& joints) const;

  /// The solution of the inverse problem that Levenberg and Marquardt's method finds from `seed`, to 1e-6 m and rad;
  /// none if there is none nearby or it leaves the limits of the joints by less than `margin` radians. It does not jump
  /// to another posture of the elbow unless the seed is far away.
  std::optional<Joints> solve(const Pose& tip, const Joints& seed, double margin = 0.0) const;

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
};

/// Limits of the joints, radians.
const Joints& lower_limits();
const Joints& upper_limits();

/// The first joint that is beyond its limit less `margin`; -1 if all are within.
int beyond_limits(const Joints& joints, double margin);

/// The posture from which solutions are sought: Rethink's "untucked", elbow out, the tool nearly straight down.
const Joints& untucked();

/// The rotation of the hand when the tool points straight down, turned about the vertical as it is when untucked.
const Eigen::Quaterniond& straight_down();

}  // namespace palpate::baxter
