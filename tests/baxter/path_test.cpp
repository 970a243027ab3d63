// SPDX-License-Identifier: MIT
// Forward kinematics and planned paths: positions of the tip between planned poses, and rejected paths.
#include "baxter/bench.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using test::fake_options;
using test::PlannerBench;

using test::kMiddle;

struct Reference {
  const char* name;
  double joints[7];
  double position[3];
  double rotation[4];  ///< x, y, z, w
};

/// left_gripper at 2.5 cm from left_hand in `base`, by KDL from baxter.urdf. The untucked pose agrees to 4 um with the
/// output of Rethink's simulator.
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
  const ArmKinematics arm({0, 0, 0.025});
  for (const Reference& one : kReferences) {
    const Pose pose = arm.tip(Joints(one.joints));
    EXPECT_LT((pose.position - Eigen::Vector3d(one.position)).norm(), 1e-6) << one.name;
    const Eigen::Vector4d rotation(one.rotation);
    const double sign = pose.rotation.coeffs().dot(rotation) < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * pose.rotation.coeffs() - rotation).norm(), 1e-6) << one.name;
  }
}

TEST(Places, OfTheSceneGoToTheRobotsFrameAndBack) {
  ScenePoseOptions place;
  place.corner[0] = 0.5;
  place.corner[1] = 0.1;
  place.height = -0.2;
  place.rotation = 0.5 * 3.14159265358979323846;
  const ArmKinematics arm(Eigen::Vector3d::Zero());
  const Planner planner(place, arm, nullptr);
  const Pose pose = planner.pose({0.03, 0.07}, 0.05);
  // A quarter turn maps x to y and y to -x.
  EXPECT_TRUE(pose.position.isApprox(Eigen::Vector3d(0.5 - 0.07, 0.1 + 0.03, -0.15), 1e-12)) << pose.position;
  EXPECT_TRUE(planner.to_scene(pose.position).isApprox(Eigen::Vector3d(0.03, 0.07, 0.05), 1e-12));
  EXPECT_TRUE((pose.rotation * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12)) << "straight down";
}

TEST(Columns, KeepTheTipOnTheVerticalBetweenThePlannedPoses) {
  const PlannerBench bench;
  for (const Target& place : {Target{0.0, 0.0}, Target{0.23, 0.0}, kMiddle, Target{0.02, 0.22}}) {
    const Path column = bench.down(place);
    ASSERT_NEAR(column.length(), 0.155, 1e-12);
    for (double along = 0.0; along < 0.155; along += 0.0007) {
      const Eigen::Vector3d tip = bench.planner.to_scene(bench.arm.tip(column.at(along)).position);
      EXPECT_NEAR(tip.x(), place.x, 1e-4);
      EXPECT_NEAR(tip.y(), place.y, 1e-4);
      EXPECT_NEAR(tip.z(), 0.135 - along, 1e-4);
    }
  }
}

TEST(Columns, AreRefusedWhereAJointWouldTurnTooFastAndOutOfReach) {
  const PlannerBench bench;
  const auto refused = [&](const Target& place, double speed) -> std::string {
    try {
      bench.planner.column(place, kMiddle, 0.135, -0.02, speed);
    } catch (const NoPath& none) {
      return none.reason;
    }
    return "";
  };
  EXPECT_EQ(refused(kMiddle, 0.03), "");
  EXPECT_THAT(refused(kMiddle, 3.0), testing::StartsWith("a joint would have to turn faster than 0.4 rad/s"));
  EXPECT_THAT(refused({0.7, 0.0}, 0.03),  // 1.2 m in front of the robot
              testing::StartsWith("no joint position within the limits puts the tool upright at ("));
}

TEST(Columns, NeverLeaveTheLimitsOfTheJoints) {
  const PlannerBench bench;
  for (double x = 0.0; x <= 0.23; x += 0.046) {
    const Path column = bench.down({x, 0.23 - x});
    for (double along = 0.0; along <= 0.155; along += 0.01) EXPECT_EQ(beyond_limits(column.at(along), 0.03), -1);
  }
}

TEST(TheWayBack, IsTheColumnFromBelow) {
  const PlannerBench bench;
  const Path column = bench.down(kMiddle);
  const Path back = column.back(0.1);
  EXPECT_NEAR(back.length(), 0.1, 1e-12);
  for (const double along : {0.0, 0.012, 0.05, 0.0999, 0.1}) {
    EXPECT_TRUE(back.at(along).isApprox(column.at(0.1 - along), 1e-12)) << along;
  }
  EXPECT_EQ(column.back(0.0).length(), 0.0);
  EXPECT_NEAR(column.back(9.0).length(), 0.155, 1e-12) << "from its end at most";
}

TEST(Lines, LeadStraightFromOnePlaceToTheOtherAndEndInItsJoints) {
  const PlannerBench bench;
  const Joints from = bench.down({0.01, 0.02}).front();
  const Joints to = bench.down({0.22, 0.21}).front();
  const Path line = bench.planner.line(from, to);
  EXPECT_EQ(line.front(), from);
  EXPECT_EQ(line.end(), to);
  for (double along = 0.0; along <= line.length(); along += 0.003) {
    const Eigen::Vector3d tip = bench.planner.to_scene(bench.arm.tip(line.at(along)).position);
    EXPECT_NEAR(tip.z(), 0.135, 3e-4);
    EXPECT_NEAR((tip.x() - 0.01) * 0.19 - (tip.y() - 0.02) * 0.21, 0.0, 1e-4) << "beside the line";
  }
}

TEST(Lines, PutALeaningToolUprightOnTheWay) {
  const PlannerBench bench;
  Joints leaning = bench.at(0.1, 0.1, 0.15);
  leaning(5) += 0.2;
  const Joints to = bench.down(kMiddle).front();
  EXPECT_EQ(bench.planner.line(leaning, to).end(), to);
}

TEST(Lines, AreRefusedWhereTheArmWouldSwingOverToAnotherPosture) {
  const PlannerBench bench;
  const Joints to = bench.down(kMiddle).front();
  Joints other = to;
  other(6) = to(6) > 0.0 ? to(6) - 5.8 : to(6) + 5.8;  // nearly the same hand, after a full turn
  EXPECT_THROW(bench.planner.line(other, to), NoPath);
}

TEST(WaysUp, LeaveTheToolAsItIs) {
  const PlannerBench bench;
  const Joints from = bench.at(0.05, 0.2, 0.01);
  const Path up = bench.planner.up(from, 0.12);
  const Pose start = bench.arm.tip(from);
  const Pose end = bench.arm.tip(up.end());
  EXPECT_TRUE((end.position - start.position).isApprox(Eigen::Vector3d(0, 0, 0.12), 1e-4));
  EXPECT_LT(end.rotation.angularDistance(start.rotation), 1e-4);
  EXPECT_EQ(bench.planner.up(from, -0.1).length(), 0.0) << "never down";
}

TEST(AdvancingOnAPath, KeepsToTheSpeedOfTheTipAndOfTheJoints) {
  const PlannerBench bench;
  const Joints from = bench.at(0.0, 0.0, 0.135);
  const Joints to = bench.at(0.23, 0.23, 0.135);
  const Path line = bench.planner.line(from, to);
  for (const double speed : {0.05, 0.3, 5.0}) {
    double along = 0.0;
    Joints last = line.front();
    int periods = 0;
    while (along < line.length()) {
      const double next = line.advance(along, speed, 0.01);
      ASSERT_GT(next, along);
      EXPECT_LE(next - along, speed * 0.01 + 1e-12);
      // After the end of a segment the next one may be slightly steeper.
      EXPECT_LE((line.at(next) - last).cwiseAbs().maxCoeff(), 1.2 * kJointSpeed * 0.01);
      last = line.at(next);
      along = next;
      ++periods;
    }
    EXPECT_GE(periods * speed * 0.01, line.length() - 1e-9);
  }
}

TEST(TheReachOfTheArea, IsWholeWhereTheFakeRobotHasItsSceneAndElseRefusedWithTheFirstPlaceThatLiesBeyond) {
  const auto reach = [](const PlannerBench& bench, double spacing) {
    return check_reach({0.23, 0.23}, spacing, [&](const Target& place) {
      bench.planner.column(place, {0.115, 0.115}, 0.135, -0.02, 0.03);
    });
  };
  EXPECT_EQ(reach(PlannerBench(), 0.02), 13 * 13);
  BaxterOptions far = fake_options();
  far.scene_pose.corner[0] = 0.85;
  try {
    reach(PlannerBench(far), 0.05);
    FAIL() << "parts of it lie more than 1 m before the robot";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::run);
    EXPECT_THAT(error.what(), testing::ContainsRegex(
                                  "scene_pose: [0-9]+ of 36 places of the area cannot be reached, the first at \\(.* "
                                  "cm, .* cm\\): .*, move the middle of the area near x = 60 cm, y = 20 cm of base"));
  }
}

}  // namespace
}  // namespace palpate::baxter
