// SPDX-License-Identifier: MIT
// Baxter's left arm as a chain of seven joints. The numbers are those of Rethink's baxter.urdf 1.2.0; the solver is
// KDL's.
#pragma once

#include "baxter/robot.hpp"

#include <memory>
#include <optional>

namespace palpate::baxter {

/// Where the joints are: the numbers of Rethink's baxter.urdf 1.2.0.
namespace description {

constexpr double kHalfPi = 1.57079632679;  // as many digits as the robot's own description has

/// Position of a joint in the frame of the one before, metres, and its rotation as roll, pitch and yaw.
struct Step {
  double x, y, z, roll, pitch, yaw;
};

/// base -> torso -> left_arm_mount, then joint by joint; every joint turns about its own z.
constexpr Step kMount = {0.024645, 0.219645, 0.118588, 0, 0, 0.7854};
constexpr Step kSteps[] = {
    {0.055695, 0, 0.011038, 0, 0, 0},            // s0
    {0.069, 0, 0.27035, -kHalfPi, 0, 0},         // s1
    {0.102, 0, 0, kHalfPi, 0, kHalfPi},          // e0
    {0.069, 0, 0.26242, -kHalfPi, -kHalfPi, 0},  // e1
    {0.10359, 0, 0, kHalfPi, 0, kHalfPi},        // w0
    {0.01, 0, 0.2707, -kHalfPi, -kHalfPi, 0},    // w1
    {0.115975, 0, 0, kHalfPi, 0, kHalfPi},       // w2
};
constexpr double kHand = 0.11355;  // left_wrist -> left_hand, along z

/// Stiffness of the springs between motors and joints, Nm/rad: Rethink's hardware specification.
constexpr double kSprings[] = {843, 843, 843, 843, 250, 250, 250};

}  // namespace description

/// The arm with something fixed to its flange (the frame `left_hand`). Safe to share; solve() is not.
class Arm {
 public:
  /// `tip`: the point of the tool that touches, in the frame left_hand, whose z axis goes on along the forearm; metres.
  explicit Arm(const Eigen::Vector3d& tip);
  ~Arm();

  /// Where the tip is, and how the hand is turned.
  Pose tip(const Joints& joints) const;

  /// Returns the vertical stiffness of the tip in `base`, N/m, with the motors held: (J_z K^-1 J_z^T)^-1, where J_z is
  /// the vertical row of the Jacobian and K the stiffness of the springs. 2.2 to 6.4 kN/m over a usual area.
  double vertical_stiffness(const Joints& joints) const;

  /// The solution of the inverse problem that Levenberg and Marquardt's method finds from `seed`, to 1e-6 m and rad;
  /// none if there is none nearby or it leaves the limits of the joints by less than `margin` radians. It does not jump
  /// to another posture of the elbow unless the seed is far away.
  std::optional<Joints> solve(const Pose& tip, const Joints& seed, double margin = 0.0) const;

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
};

/// Limits of the joints, radians.
Joints lower_limits();
Joints upper_limits();

/// The first joint that is beyond its limit less `margin`; -1 if all are within.
int beyond_limits(const Joints& joints, double margin);

/// The posture from which solutions are sought: Rethink's "untucked", elbow out, the tool nearly straight down.
Joints untucked();

/// The rotation of the hand when the tool points straight down, turned about the vertical as it is when untucked.
const Eigen::Quaterniond& straight_down();

}  // namespace palpate::baxter
