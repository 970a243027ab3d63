// SPDX-License-Identifier: MIT
#include "baxter/kinematics.hpp"

#include <gtest/gtest.h>

namespace palpate::test {
namespace {

struct Reference {
  const char* name;
  double joints[7];
  double position[3];
  double rotation[4];  ///< x, y, z, w
};

/// left_gripper at 2.5 cm from left_hand in `base`, by KDL from baxter.urdf; the untucked one agrees to 4 um with what
/// Rethink's own simulator printed.
constexpr Reference kReferences[] = {
    {"zero",
     {0, 0, 0, 0, 0, 0, 0},
     {0.815139432, 1.010142336, 0.320976000},
     {-0.270598650, 0.653281234, 0.270598650, 0.653281234}},
    {"neutral",
     {0, -0.55, 0, 0.75, 0, 1.26, 0},
     {0.635882963, 0.830885208, 0.194504533},
     {-0.382097210, 0.922461871, 0.021189164, 0.051155035}},
    {"untucked",
     {-0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.50},
     {0.572578521, 0.181185820, 0.246191687},
     {0.140770497, 0.989645262, 0.011654257, 0.025497091}},
    {"tucked",
     {-1.0, -2.07, 3.0, 2.55, 0, 0.01, 0},
     {-0.126864508, 0.359744037, 0.061574305},
     {-0.984420828, 0.167043900, 0.036945975, 0.040582793}},
    {"other",
     {0.3, -0.4, 0.2, 1.1, -0.5, 0.8, 1.5},
     {0.380482185, 0.936363794, -0.011488695},
     {0.005076427, 0.994124558, 0.029037588, 0.104150910}},
};

TEST(BaxterKinematics, AgreesWithFiveReferencePoses) {
  const baxter::Arm arm({0, 0, 0.025});
  for (const Reference& one : kReferences) {
    const baxter::Pose pose = arm.tip(baxter::Joints(one.joints));
    EXPECT_LT((pose.position - Eigen::Vector3d(one.position)).norm(), 1e-6) << one.name;
    const Eigen::Vector4d rotation(one.rotation);
    const double sign = pose.rotation.coeffs().dot(rotation) < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * pose.rotation.coeffs() - rotation).norm(), 1e-6) << one.name;
  }
}

}  // namespace
}  // namespace palpate::test
