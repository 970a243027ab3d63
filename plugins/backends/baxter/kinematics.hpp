// SPDX-License-Identifier: MIT
// Kinematics of Baxter's left arm, a chain of seven joints. The geometry is that of Rethink's baxter.urdf 1.2.0; KDL
// solves the inverse problem.
#pragma once

#include "baxter/robot.hpp"

#include <memory>
#include <optional>

namespace palpate::baxter {

/// Geometry and stiffness of the joints. Source of the geometry: Rethink's baxter.urdf 1.2.0.
namespace geometry {

constexpr double kHalfPi = 1.57079632679;  // rounded as in baxter.urdf

/// Position of a joint in the frame of the previous joint, in metres, and its rotation as roll, pitch and yaw in
/// radians.
struct JointTransform {
  double x, y, z, roll, pitch, yaw;
};

/// Transforms base -> torso -> left_arm_mount (kMount), then one transform per joint. Every joint rotates about its own
/// z axis.
constexpr JointTransform kMount = {0.024645, 0.219645, 0.118588, 0, 0, 0.7854};
constexpr JointTransform kSteps[] = {
    {0.055695, 0, 0.011038, 0, 0, 0},            // s0
    {0.069, 0, 0.27035, -kHalfPi, 0, 0},         // s1
    {0.102, 0, 0, kHalfPi, 0, kHalfPi},          // e0
    {0.069, 0, 0.26242, -kHalfPi, -kHalfPi, 0},  // e1
    {0.10359, 0, 0, kHalfPi, 0, kHalfPi},        // w0
    {0.01, 0, 0.2707, -kHalfPi, -kHalfPi, 0},    // w1
    {0.115975, 0, 0, kHalfPi, 0, kHalfPi},       // w2
};
constexpr double kHand = 0.11355;  // m from left_wrist to left_hand, along z

/// Stiffness of the springs between motors and joints, Nm/rad. Source: Rethink's hardware specification.
constexpr double kSprings[] = {843, 843, 843, 843, 250, 250, 250};

}  // namespace geometry

/// The arm with a tool fixed to its flange (frame `left_hand`). Const methods may be called from several threads,
/// except solve().
class ArmKinematics {
 public:
  /// `tip`: contact point of the tool in the frame left_hand, in metres. The z axis of left_hand points away from the
  /// forearm.
  explicit ArmKinematics(const Eigen::Vector3d& tip);
  ~ArmKinematics();

  /// Returns the position of the tip and the rotation of the hand, in the frame `base`.
  Pose tip(const Joints& joints) const;

  /// Returns the vertical stiffness of the tip in `base`, in N/m, with the motors held: (J_z * K^-1 * J_z^T)^-1. J_z is
  /// the vertical row of the Jacobian and K the stiffness of the springs. Typical values over a usual area are 2.2 to
  /// 6.4 kN/m.
  double vertical_stiffness(const Joints& joints) const;

  /// Returns joints that put the tip at the pose `tip`, to 1e-6 m and rad, by the Levenberg-Marquardt method, started
  /// from `seed`. Returns nullopt if the method finds none, or if a joint is closer to its limit than `margin` radians.
  /// The elbow keeps its posture unless the seed is far from the solution.
  std::optional<Joints> solve(const Pose& tip, const Joints& seed, double margin = 0.0) const;

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
};

/// Limits of the joints, radians.
Joints lower_limits();
Joints upper_limits();

/// Returns the index of the first joint that is closer to its limit than `margin` radians, or -1 if there is none.
int beyond_limits(const Joints& joints, double margin);

/// Returns the start posture of inverse kinematics: Rethink's "untucked", with the elbow out and the tool nearly
/// vertical.
Joints untucked();

/// Returns the rotation of the hand with the tool pointing straight down. The rotation about the vertical is that of
/// untucked().
const Eigen::Quaterniond& straight_down();

}  // namespace palpate::baxter
