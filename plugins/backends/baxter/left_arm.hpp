// SPDX-License-Identifier: MIT
// Where the joints of Baxter's left arm are: the numbers of Rethink's baxter.urdf 1.2.0.
#pragma once

namespace palpate::baxter::description {

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

}  // namespace palpate::baxter::description
