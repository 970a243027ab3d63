// SPDX-License-Identifier: MIT
// Checks before any motion, and inverse kinematics by the robot.
#include "baxter/tapper_bench.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace palpate::baxter {
namespace {

using fake_baxter::FaultKind;
using test::asking;
using test::fake_options;
using test::kOnObject;
using test::with;
using Bench = test::TapperBench;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ADryRun, CommandsNothing) {
  Bench bench(with([](BaxterOptions& o) { o.dry_run = true; }));
  bench.robot.body.inject({FaultKind::tucked, 0.0, {}});
  bench.check();
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, StartsWith("dry run"));
  EXPECT_TRUE(bench.robot.commands.empty());
  EXPECT_THAT(bench.notes, testing::Contains(HasSubstr("all 169 places of the area can be reached")));
}

using Answer = std::optional<Joints>;

TEST(TheRobotsInverseKinematics, IsAskedForEveryPose) {
  Bench bench(asking());
  bench.touch(kOnObject);
  EXPECT_GT(bench.robot.asked, 30);
}

TEST(TheRobotsInverseKinematics, IsNotBelieved) {
  const ArmKinematics gripper({0, 0, 0.025});
  const std::function<Answer(const Pose&, const Joints&)> answers[] = {
      [](const Pose&, const Joints&) { return Answer(); },
      [](const Pose&, const Joints&) { return Answer(Joints::Constant(std::nan(""))); },
      [&](const Pose& pose, const Joints& seed) {  // another position
        return gripper.solve({pose.position + Eigen::Vector3d(0, 0, 0.002), pose.rotation}, seed);
      },
      [&](const Pose& pose, const Joints& seed) {  // beyond a limit
        Answer out = gripper.solve(pose, seed);
        if (out) (*out)(6) += 2.0 * 3.14159265358979323846;
        return out;
      }};
  for (const auto& one : answers) {
    Bench bench(asking());
    bench.robot.answer = one;
    const tapping::HeightResult contact = bench.tap(kOnObject);
    EXPECT_EQ(contact.outcome, Outcome::unreachable) << contact.reason;
    EXPECT_TRUE(bench.robot.commands.empty());
  }
}

TEST(TheRobotsInverseKinematics, EndsTheRunBeforeAnythingMovesWhenItDoesNotAnswer) {
  Bench bench(asking());
  bench.robot.answer = test::silent_service;
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_THAT(contact.reason, StartsWith("IKService did not answer"));
  EXPECT_TRUE(bench.robot.commands.empty());
}

/// Expects this one-line error before any set-point, or none if `reason` is empty.
void expect_check(Bench& bench, const std::string& reason) {
  std::string said;
  try {
    bench.check();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::run);
    said = error.what();
  }
  EXPECT_EQ(said.empty(), reason.empty()) << said;
  EXPECT_THAT(said, HasSubstr(reason));
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(BeforeFlight, WhatTheRobotSaysIsRefusedWhereTheArmWouldNotDoWhatItIsTold) {
  const auto ratio = [](double value) {
    return [=](Snapshot& s) { s.speed_ratio = ReceivedSetting{value, "/other"}; };
  };
  const auto timeout = [](double value) {
    return [=](Snapshot& s) { s.command_timeout = ReceivedSetting{value, "/other"}; };
  };
  const auto avoids = [](bool arm, const std::vector<std::string>& objects) {
    return [=](Snapshot& s) { s.avoidance = AvoidanceReading{{}, arm, objects}; };
  };
  const auto seldom = [held = std::optional<EndpointReading>()](Snapshot& s) mutable {  // 25 Hz
    if (!held || s.now - held->received >= 0.04 - 1e-9) held = s.endpoint;
    s.endpoint = held;
  };
  const char* other_timeout = "set it to 0.2, on /robot/limb/left/joint_command_timeout";
  const std::pair<std::function<void(Snapshot&)>, const char*> cases[] = {
      {ratio(0.3), ""},
      {ratio(0.03), "/other has set it to 0.03, too low for the arm to follow"},
      {timeout(0.2), ""},
      {timeout(0.02), other_timeout},
      {timeout(5.0), other_timeout},
      {timeout(std::nan("")), other_timeout},
      {avoids(false, {}), ""},
      {avoids(true, {"torso"}), "pushes the arm away from the other arm and torso"},
      {seldom, "endpoint_state of the left arm arrived only "}};
  for (const auto& [spoil, reason] : cases) {
    Bench bench;
    bench.robot.spoil = spoil;
    expect_check(bench, reason);
  }
}

TEST(BeforeFlight, WhatOthersLeftOnTheRobotIsTold) {
  Bench bench;
  bench.robot.spoil = [](Snapshot& s) {
    s.speed_ratio = ReceivedSetting{0.5, "/other"};
    s.end_effector = {"rethink electric gripper", 0.8};
  };
  bench.check();
  EXPECT_THAT(bench.notes, testing::ElementsAre(StartsWith("set_speed_ratio: 0.5 from /other"),
                                                HasSubstr("joint_command_timeout: not published"),
                                                HasSubstr("rethink electric gripper, 0.8 kg beyond the flange")));
}

TEST(BeforeFlight, AnArmThatIsNotAsTheConfigHasItIsRefused) {
  Bench longer(fake_options(), [](test::BodyOptions& body) { body.tool.gripper = 0.1585; });
  expect_check(longer,
               "tool.gripper: the robot has left_gripper 15.85 cm from left_hand, the config has it at 2.50 cm");
  Bench beside(fake_options(), [](test::BodyOptions& body) { body.start_at = Eigen::Vector3d(-0.12, 0.1, 0.2); });
  expect_check(beside, "more than 10 cm outside the area, move the tool by hand to a position above the area");
  Bench leaning;
  Joints lean = leaning.robot.body.joints();
  lean(5) -= 0.5;
  leaning.lead_away(lean);
  expect_check(leaning, "the tool does not point down");
}

TEST(BeforeFlight, AStateInWhichItMustNotMoveIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"disabled", "the robot is disabled: enable it"},
      {"zero_wrench", "a force of exactly zero"},
      {"second_sender=state", "/robot/state comes from more than one node, /realtime_loop and /mock_robot"},
      {"second_sender=endpoint", "endpoint_state of the left arm comes from more than one node"},
      {"second_sender=joints", "/robot/joint_states of the left arm comes from more than one node"},
      {"second_sender=collision", "collision_detection_state of the left arm comes from more than one node"},
      {"second_sender=avoidance", "collision_avoidance_state of the left arm comes from more than one node"},
      {"slow_force=20", "with a new force only"},
      {"estop=100", "the emergency stop is pressed"},
      {"error", "the robot reports an error and is disabled"},
  };
  for (const auto& [fault, reason] : cases) {
    Bench bench;
    bench.robot.body.inject(fake_baxter::parse_fault(fault));
    bench.robot.wait_until(bench.robot.body.now() + 0.1);
    expect_check(bench, reason);
  }
}

TEST(BeforeFlight, ACalibrationTapBesideTheAreaIsRefused) {
  Bench bench(with([](BaxterOptions& o) { test::calibrate(o, 0.25, 0.0); }));
  expect_check(bench, "calibration.at: is outside the area");
}

TEST(BeforeFlight, ADryRunWithoutAnAnswerOfTheRobotsInverseKinematicsSaysSo) {
  BaxterOptions options = asking();
  options.dry_run = true;
  Bench bench(options);
  bench.robot.answer = test::silent_service;
  expect_check(bench, "IKService did not answer");
}

}  // namespace
}  // namespace palpate::baxter
