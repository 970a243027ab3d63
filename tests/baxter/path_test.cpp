// SPDX-License-Identifier: MIT
// The ways that are planned for the arm: where the tip goes between the planned poses, and what is refused.
#include "baxter/bench.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using test::fake_options;
using test::PlannerBench;

constexpr Target kMiddle{0.115, 0.115};

TEST(Places, OfTheSceneGoToTheRobotsFrameAndBack) {
  PlaceOptions place;
  place.corner[0] = 0.5;
  place.corner[1] = 0.1;
  place.height = -0.2;
  place.rotation = 0.5 * 3.14159265358979323846;
  const Arm arm(Eigen::Vector3d::Zero());
  const Planner planner(place, arm, nullptr);
  const Pose pose = planner.pose({0.03, 0.07}, 0.05);
  // A quarter turn takes x to y and y to -x.
  EXPECT_TRUE(pose.position.isApprox(Eigen::Vector3d(0.5 - 0.07, 0.1 + 0.03, -0.15), 1e-12)) << pose.position;
  EXPECT_TRUE(planner.to_scene(pose.position).isApprox(Eigen::Vector3d(0.03, 0.07, 0.05), 1e-12));
  EXPECT_TRUE((pose.rotation * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12)) << "straight down";
}

TEST(Columns, KeepTheTipOnTheVerticalBetweenThePlannedPoses) {
  const PlannerBench bench;
  for (const Target& place : {Target{0.0, 0.0}, Target{0.23, 0.0}, kMiddle, Target{0.02, 0.22}}) {
    const Path column = bench.planner.column(place, kMiddle, 0.135, -0.02, 0.03);
    ASSERT_NEAR(column.length(), 0.155, 1e-12);
    for (double along = 0.0; along < 0.155; along += 0.0007) {
      const Eigen::Vector3d tip = bench.planner.to_scene(bench.arm.tip(column.at(along)).position);
      EXPECT_NEAR(tip.x(), place.x, 1e-4);
      EXPECT_NEAR(tip.y(), place.y, 1e-4);
      EXPECT_NEAR(tip.z(), 0.135 - along, 1e-4);
    }
  }
}

TEST(Columns, AreRefusedWhereAJointWouldTurnTooFast) {
  const PlannerBench bench;
  EXPECT_NO_THROW(bench.planner.column(kMiddle, kMiddle, 0.135, -0.02, 0.03));
  EXPECT_THROW(bench.planner.column(kMiddle, kMiddle, 0.135, -0.02, 3.0), NoPath);
}

TEST(Columns, AreRefusedOutOfReach) {
  const PlannerBench bench;
  try {
    bench.planner.column({0.7, 0.0}, kMiddle, 0.135, -0.02, 0.03);
    FAIL() << "it lies 1.2 m before the robot";
  } catch (const NoPath& none) {
    EXPECT_THAT(none.reason,
                testing::StartsWith("no position of the joints within their limits puts the tool upright at ("));
  }
}

TEST(Columns, NeverLeaveTheLimitsOfTheJoints) {
  const PlannerBench bench;
  for (double x = 0.0; x <= 0.23; x += 0.046) {
    const Path column = bench.planner.column({x, 0.23 - x}, kMiddle, 0.135, -0.02, 0.03);
    for (double along = 0.0; along <= 0.155; along += 0.01) EXPECT_EQ(beyond_limits(column.at(along), 0.03), -1);
  }
}

TEST(TheWayBack, IsTheColumnFromBelow) {
  const PlannerBench bench;
  const Path column = bench.planner.column(kMiddle, kMiddle, 0.135, -0.02, 0.03);
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
  const Joints from = bench.planner.column({0.01, 0.02}, kMiddle, 0.135, -0.02, 0.03).front();
  const Joints to = bench.planner.column({0.22, 0.21}, kMiddle, 0.135, -0.02, 0.03).front();
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
  const Joints to = bench.planner.column(kMiddle, kMiddle, 0.135, -0.02, 0.03).front();
  EXPECT_EQ(bench.planner.line(leaning, to).end(), to);
}

TEST(Lines, AreRefusedWhereTheArmWouldSwingOverToAnotherPosture) {
  const PlannerBench bench;
  const Joints to = bench.planner.column(kMiddle, kMiddle, 0.135, -0.02, 0.03).front();
  Joints other = to;
  other(6) = to(6) > 0.0 ? to(6) - 5.8 : to(6) + 5.8;  // nearly the same hand, turned all the way round
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
      // Where a segment ends, the next may be a little steeper.
      EXPECT_LE((line.at(next) - last).cwiseAbs().maxCoeff(), 1.2 * kJointSpeed * 0.01);
      last = line.at(next);
      along = next;
      ++periods;
    }
    EXPECT_GE(periods * speed * 0.01, line.length() - 1e-9);
  }
}

TEST(TheReachOfTheArea, IsWholeWhereTheFakeRobotHasItsScene) {
  const PlannerBench bench;
  EXPECT_EQ(check_reach(bench.planner, {0.23, 0.23}, 0.135, -0.02, 0.03, 0.02), 13 * 13);
}

TEST(TheReachOfTheArea, IsRefusedWithTheFirstPlaceThatLiesBeyond) {
  BaxterOptions far = fake_options();
  far.place.corner[0] = 0.85;
  const PlannerBench bench(far);
  try {
    check_reach(bench.planner, {0.23, 0.23}, 0.135, -0.02, 0.03, 0.05);
    FAIL() << "parts of it lie more than 1 m before the robot";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::run);
    EXPECT_THAT(error.what(),
                testing::ContainsRegex("place: [0-9]+ of 36 places of the area cannot be reached, the first at "
                                       "\\(.* cm, .* cm\\): "));
    EXPECT_THAT(error.what(), testing::EndsWith("put the middle of the area near x = 60 cm, y = 20 cm of base"));
  }
}

}  // namespace
}  // namespace palpate::baxter
