// SPDX-License-Identifier: MIT
// What must be right before anything moves, and where joints come from if the robot is asked for them.
#include "baxter/tapper_bench.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace palpate::baxter {
namespace {

using fake_baxter::FaultKind;
using test::fake_options;
using test::kOnObject;
using test::wave_scene;
using Bench = test::TapperBench;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ADryRun, CommandsNothing) {
  BaxterOptions options = fake_options();
  options.dry_run = true;
  Bench bench(options, fake_options(), [](test::BodyOptions& body) { body.start = fake_baxter::Start::tucked; });
  bench.robot.body.inject({FaultKind::tucked, 0.0, {}});
  bench.check();
  const Contact contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, StartsWith("dry run"));
  EXPECT_TRUE(bench.robot.commands.empty());
  EXPECT_THAT(bench.notes, testing::Contains(HasSubstr("all 169 places of the area can be reached")));
}

TEST(BeforeFlight, WhatOthersLeftOnTheRobotIsToldAndRefusedWhereTheArmWouldNotDoWhatItIsTold) {
  const auto refusal = [](const std::function<void(Snapshot&)>& spoil) -> std::string {
    Bench bench;
    bench.robot.spoil = spoil;
    try {
      bench.check();
    } catch (const Error& error) {
      EXPECT_TRUE(bench.robot.commands.empty());
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal([](Snapshot& s) { s.speed_ratio = Setting{0.3, "/other"}; }), "");
  EXPECT_THAT(refusal([](Snapshot& s) {
                s.speed_ratio = Setting{0.03, "/other"};
              }),
              HasSubstr("/other has set it to 0.03, at which the arm cannot follow"));
  EXPECT_EQ(refusal([](Snapshot& s) { s.command_timeout = Setting{0.2, "/other"}; }), "");
  for (const double timeout : {0.02, 5.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(refusal([&](Snapshot& s) {
                  s.command_timeout = Setting{timeout, "/other"};
                }),
                HasSubstr("set it to 0.2, on /robot/limb/left/joint_command_timeout"));
  }
  EXPECT_EQ(refusal([](Snapshot& s) { s.avoidance = AvoidanceReading{}; }), "");
  EXPECT_THAT(refusal([](Snapshot& s) {
                s.avoidance = AvoidanceReading{};
                s.avoidance->other_arm = true;
                s.avoidance->objects = {"torso"};
              }),
              HasSubstr("pushes the arm away from the other arm and torso"));
  Bench bench;
  bench.robot.spoil = [](Snapshot& s) {
    s.speed_ratio = Setting{0.5, "/other"};
    s.end_effector = {"rethink electric gripper", 0.8};
  };
  bench.check();
  EXPECT_THAT(bench.notes, testing::ElementsAre(StartsWith("set_speed_ratio: 0.5 from /other"),
                                                HasSubstr("joint_command_timeout: nobody says it now"),
                                                HasSubstr("rethink electric gripper, 0.8 kg beyond the flange")));
}

BaxterOptions asking() {
  BaxterOptions out = fake_options();
  out.inverse_kinematics = BaxterOptions::InverseKinematics::robot;
  return out;
}

TEST(TheRobotsInverseKinematics, IsAskedForEveryPose) {
  Bench bench(asking());
  const Contact contact = bench.tap(kOnObject);
  ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
  EXPECT_NEAR(contact.height, wave_scene().height(kOnObject.x, kOnObject.y), 0.002);
  EXPECT_GT(bench.robot.asked, 30);
}

TEST(TheRobotsInverseKinematics, IsNotBelieved) {
  const Arm gripper({0, 0, 0.025});
  const auto expect_unreachable = [](const std::function<Robot::Answer(const Pose&, const Joints&)>& answer) {
    Bench bench(asking());
    bench.robot.answer = answer;
    const Contact contact = bench.tap(kOnObject);
    EXPECT_EQ(contact.outcome, Outcome::unreachable) << contact.reason;
    EXPECT_TRUE(bench.robot.commands.empty());
  };
  expect_unreachable([](const Pose&, const Joints&) { return Robot::Answer{}; });
  expect_unreachable([](const Pose&, const Joints&) {
    return Robot::Answer{Joints::Constant(std::numeric_limits<double>::quiet_NaN()), {}};
  });
  expect_unreachable([&](const Pose& pose, const Joints& seed) {  // another place
    Pose off = pose;
    off.position.z() += 0.002;
    return Robot::Answer{gripper.solve(off, seed), {}};
  });
  expect_unreachable([&](const Pose& pose, const Joints& seed) {  // beyond a limit
    Robot::Answer out{gripper.solve(pose, seed), {}};
    if (out.joints) (*out.joints)(6) += 2.0 * 3.14159265358979323846;
    return out;
  });
}

TEST(TheRobotsInverseKinematics, EndsTheRunBeforeAnythingMovesWhenItDoesNotAnswer) {
  Bench bench(asking());
  bench.robot.answer = [](const Pose&, const Joints&) { return Robot::Answer{{}, "IKService did not answer"}; };
  const Contact contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_THAT(contact.reason, StartsWith("IKService did not answer"));
  EXPECT_TRUE(bench.robot.commands.empty());
}

void expect_refused(Bench& bench, const std::string& reason) {
  try {
    bench.check();
    FAIL() << "expected: " << reason;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
    EXPECT_EQ(error.kind(), Error::Kind::run);
  }
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(BeforeFlight, AGripperThatTheConfigDoesNotKnowIsNamedWithItsLength) {
  BaxterOptions truth = fake_options();
  truth.tool.gripper = 0.1585;
  Bench bench(fake_options(), truth);
  expect_refused(bench,
                 "tool.gripper: the robot has left_gripper 15.85 cm from left_hand, the config has it at 2.50 cm");
}

TEST(BeforeFlight, AnArmBesideTheAreaIsRefused) {
  Bench bench(fake_options(), fake_options(),
              [](test::BodyOptions& body) { body.start_at = Eigen::Vector3d(-0.12, 0.1, 0.2); });
  expect_refused(bench, "more than 10 cm beside the area, bring the tool by hand to a place above the area");
}

TEST(BeforeFlight, AToolThatDoesNotPointDownIsRefused) {
  Bench bench;
  Joints leaning = bench.robot.body.joints();
  leaning(5) -= 0.5;
  for (int i = 0; i < 500; ++i) {
    bench.robot.body.command(leaning);
    bench.robot.wait_until(bench.robot.body.now() + 0.01);
  }
  expect_refused(bench, "the tool does not point down");
}

TEST(BeforeFlight, AStateInWhichItMustNotMoveIsNamed) {
  const std::vector<std::pair<FaultKind, const char*>> cases{
      {FaultKind::disabled, "the robot is disabled: enable it"},
      {FaultKind::zero_wrench, "a force of exactly zero"},
      {FaultKind::second_state, "more than one node, /realtime_loop and /mock_robot"},
      {FaultKind::estop, "the emergency stop is pressed"},
      {FaultKind::error, "the robot reports an error and is disabled"},
  };
  for (const auto& [kind, reason] : cases) {
    Bench bench;
    bench.robot.body.inject({kind, 100.0, {}});
    bench.robot.wait_until(bench.robot.body.now() + 0.1);
    expect_refused(bench, reason);
  }
}

TEST(BeforeFlight, ACalibrationTapBesideTheAreaIsRefused) {
  BaxterOptions options = fake_options();
  options.calibration.emplace();
  options.calibration->at[0] = 0.25;
  Bench bench(options);
  expect_refused(bench, "calibration.at: lies outside of the area");
}

TEST(BeforeFlight, ADryRunWithoutAnAnswerOfTheRobotsInverseKinematicsSaysSo) {
  BaxterOptions options = asking();
  options.dry_run = true;
  Bench bench(options);
  bench.robot.answer = [](const Pose&, const Joints&) { return Robot::Answer{{}, "IKService did not answer"}; };
  expect_refused(bench, "IKService did not answer");
}

}  // namespace
}  // namespace palpate::baxter
