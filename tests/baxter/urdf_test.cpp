// SPDX-License-Identifier: MIT
// Mass of the tool in the robot's URDF.
#include "baxter/urdf.hpp"

#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

/// Part of baxter.urdf, with a fragment in the form of Rethink's gripper plugins.
constexpr const char* kArm = R"(<?xml version="1.0" ?>
<!-- <link name="left_hand"><inertial><mass value="99"/></inertial></link> -->
<robot name="baxter" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="left_wrist"><inertial><mass value="0.35093"/></inertial></link>
  <link name="left_hand">
    <visual><geometry><mesh filename='a>b.DAE'/></geometry></visual>
    <inertial>
      <origin rpy="0 0 0" xyz="1e-08 1e-08 1e-08"/>
      <mass value="0.19125"/>
    </inertial>
  </link>
  <link name="left_hand_camera"/>
  <joint name="left_hand_camera" type="fixed">
    <parent link="left_hand"/>
    <child link="left_hand_camera"/>
  </joint>
  <link name="left_gripper_base"><inertial><mass value = '0.0001'/></inertial></link>
  <link name="left_gripper_mass"><inertial><mass value="1.18"/></inertial></link>
  <link name="right_gripper"><inertial><mass value="5"/></inertial></link>
  <joint name="right_endpoint" type="fixed"><parent link="right_hand"/><child link="right_gripper"/></joint>
  <joint name="left_gripper_mass" type="fixed"><child link="left_gripper_mass"/><parent link="left_gripper_base"/></joint>
  <joint name="left_gripper_base" type="fixed"><parent link="left_hand"/><child link="left_gripper_base"/></joint>
  <joint name="left_hand" type="fixed"><parent link="left_wrist"/><child link="left_hand"/></joint>
  <transmission name="t"><joint name="left_w2"/><actuator name="a"/></transmission>
</robot>
)";

TEST(Description, CountsWhatHangsOnALinkDirectlyOrThroughOthersAndNothingElse) {
  EXPECT_NEAR(mass_beyond(kArm, "left_hand").value(), 1.18 + 0.0001, 1e-12);
  EXPECT_NEAR(mass_beyond(kArm, "left_wrist").value(), 0.19125 + 1.18 + 0.0001, 1e-12);
  EXPECT_EQ(mass_beyond(kArm, "left_gripper_mass").value(), 0.0);
}

TEST(Description, WithoutTheLinkOrAUrdfThereIsNoMass) {
  EXPECT_FALSE(mass_beyond(kArm, "left_foot"));
  for (const char* text :
       {"", "<", "<link", "<link name=", "<link name=\"left_hand", "</", "<!--", "<?", "left_hand"}) {
    EXPECT_FALSE(mass_beyond(text, "left_hand")) << text;
  }
}

TEST(Description, AMassThatIsNoneMakesTheSumUnknown) {
  for (const char* value : {"-1", "nan", "heavy", "", "1 kg", "1e999"}) {
    const std::string urdf =
        std::string("<robot><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"") + value +
        "\"/></inertial></link><joint name=\"j\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    EXPECT_FALSE(mass_beyond(urdf, "a")) << value;
    EXPECT_TRUE(mass_beyond(urdf, "b")) << "it is not beyond";
  }
}

TEST(Description, LinksThatHangOnEachOtherAreCountedOnce) {
  const std::string urdf =
      "<robot><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"2\"/></inertial></link>"
      "<joint name=\"i\"><parent link=\"a\"/><child link=\"b\"/></joint>"
      "<joint name=\"j\"><parent link=\"b\"/><child link=\"a\"/></joint></robot>";
  EXPECT_EQ(mass_beyond(urdf, "a"), 2.0);
}

TEST(Description, HoweverDeepATextIsItIsRead) {
  std::string deep;
  for (int i = 0; i < 1000000; ++i) deep += "<a>";
  EXPECT_FALSE(mass_beyond(deep, "left_hand"));
}

}  // namespace
}  // namespace palpate::baxter
