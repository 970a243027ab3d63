// SPDX-License-Identifier: MIT
// Every safety rule, at a value that just satisfies it and at one that just breaks it.
#include "baxter/guard_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace palpate::baxter {
namespace {

using test::IsFault;
using test::IsNothing;
using test::kInside;
using test::kSpace;
using test::kZero;
using test::pose;
using test::Rules;
using test::sound;
using test::Spoil;
using testing::HasSubstr;
using AllowedAction = Fault::AllowedAction;
using Button = StateReading::Button;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A defect of a robot, with the expected message and action.
struct Wrong {
  const char* name;
  Spoil spoil;
  const char* reason;
  AllowedAction then = AllowedAction::silence;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.reason; }

class BrokenRule : public testing::TestWithParam<Wrong> {};

TEST_P(BrokenRule, StopsTheArmAndSaysWhy) {
  Rules rules;
  ASSERT_THAT(rules.at(1.0), IsNothing()) << "before";
  const std::optional<Fault> fault = rules.at(1.01, GetParam().spoil);
  ASSERT_THAT(fault, IsFault(GetParam().reason, GetParam().then));
  EXPECT_TRUE(fault->ends_run);
}

INSTANTIATE_TEST_SUITE_P(
    OfTheRobot, BrokenRule,
    testing::Values(
        Wrong{"EmergencyStop", [](Snapshot& s) { s.state->estop_button = Button::pressed; },
              "the emergency stop is pressed: release it"},
        Wrong{"EmergencyStopReleased", [](Snapshot& s) { s.state->estop_button = Button::released; },
              "was pressed and is released: reset it (rosrun"},
        Wrong{"Error",
              [](Snapshot& s) {
                s.state->error = true;
                s.state->enabled = false;
              },
              "reports an error and is disabled: check its screen, then reset it (rosrun baxter_tools enable_robot.py "
              "-r)"},
        Wrong{"Stopped", [](Snapshot& s) { s.state->stopped = true; }, "the robot is stopped"},
        Wrong{"Disabled", [](Snapshot& s) { s.state->enabled = false; }, "the robot is disabled: enable it"},
        Wrong{"Tucked",
              [](Snapshot& s) {
                s.state->enabled = false;
                s.joints->position(1) = -2.07;
              },
              "its arm is tucked (left_s1 at -118.6 deg): untuck it"},
        Wrong{"NotReady", [](Snapshot& s) { s.state->ready = false; }, "not ready"},
        Wrong{"OldState", [](Snapshot& s) { s.state->received -= 0.51; }, "/robot/state did not arrive for 0.51 s"},
        Wrong{"TwoSendersOfState", [](Snapshot& s) { s.senders.state.push_back("/mock"); },
              "/robot/state comes from more than one node, /realtime_loop and /mock"},
        Wrong{"TwoSendersOfJoints", [](Snapshot& s) { s.senders.joints.push_back("/mock"); },
              "/robot/joint_states of the left arm comes from more than one node"},
        Wrong{"TwoClocks",
              [](Snapshot& s) {
                s.senders.clock = {"/a", "/b"};
              },
              "/clock comes from more than one node"},
        Wrong{"TwoSendersOfEndpoint", [](Snapshot& s) { s.senders.endpoint.push_back("/mock"); },
              "endpoint_state of the left arm comes from more than one node, /realtime_loop and /mock",
              AllowedAction::hold},
        Wrong{"TwoSendersOfCollisions", [](Snapshot& s) { s.senders.collision.push_back("/mock"); },
              "collision_detection_state of the left arm comes from more than one node", AllowedAction::hold},
        Wrong{"TwoSendersOfAvoidance",
              [](Snapshot& s) {
                s.senders.avoidance = {"/a", "/b"};
              },
              "collision_avoidance_state of the left arm comes from more than one node", AllowedAction::hold},
        Wrong{"LowSpeedRatio",
              [](Snapshot& s) {
                s.speed_ratio = ReceivedSetting{0.05, "/other"};
              },
              "set_speed_ratio: /other has set it to 0.05, too low for the arm to follow: set it to 0.3, on "
              "/robot/limb/left/set_speed_ratio",
              AllowedAction::hold},
        Wrong{"ShortTimeout",
              [](Snapshot& s) {
                s.command_timeout = ReceivedSetting{0.02, "/other"};
              },
              "set it to 0.2, on /robot/limb/left/joint_command_timeout", AllowedAction::hold},
        Wrong{"Malformed", [](Snapshot& s) { s.malformed = "joint_states has 17 names and 3 positions"; },
              "17 names and 3 positions"},
        Wrong{"OldJoints", [](Snapshot& s) { s.joints->received -= 0.11; },
              "joint_states of the left arm did not arrive"},
        Wrong{"OldEndpoint", [](Snapshot& s) { s.endpoint->received -= 0.11; },
              "endpoint_state of the left arm did not", AllowedAction::hold},
        Wrong{"JointIsNoNumber", [](Snapshot& s) { s.joints->position(3) = kNaN; }, "a position that is not a number"},
        Wrong{"ForceIsNoNumber", [](Snapshot& s) { s.endpoint->force.z() = kNaN; },
              "a force or a position that is not a number", AllowedAction::hold},
        Wrong{"NoForce", [](Snapshot& s) { s.endpoint->force.setZero(); }, "exactly zero", AllowedAction::hold},
        Wrong{"StampsLag", [](Snapshot& s) { s.endpoint->stamp -= 0.31; },
              "endpoint_state arrives with time stamps 0.31 s older", AllowedAction::hold},
        Wrong{"JointStampsLag", [](Snapshot& s) { s.joints->stamp -= 0.31; },
              "joint_states arrives with time stamps 0.31 s older"},
        Wrong{"Jump", [](Snapshot& s) { s.joints->position(2) += 0.07; }, "/robot/joint_states jumped by 4.0 deg"},
        Wrong{"CommandedByAnother", [](Snapshot& s) { s.commanders = {"/palpate_2"}; },
              "the arm is also commanded by /palpate_2: end that program first"},
        Wrong{"StoppedByAProgram",
              [](Snapshot& s) {
                s.state->stopped = true;
                s.state->estop_button = Button::unknown;
              },
              "a program, perhaps a safety node, stopped the robot (/robot/set_super_stop)"},
        Wrong{"Reflex", [](Snapshot& s) { s.collision->collision = true; }, "the arm's own reflex stopped it",
              AllowedAction::retreat}),
    [](const auto& wrong) { return std::string(wrong.param.name); });

TEST(AJoint, BeyondItsLimitIsNamed) {
  Joints joints = pose();
  joints(3) = 2.62;
  EXPECT_THAT(Rules().at(1.0, nullptr, joints),
              IsFault("left_e1 is at 150.1 deg, beyond its limit", AllowedAction::hold));
}

TEST(JointsThatAreNotKnown, AreNotHeldWhateverElseIsWrong) {
  const Spoil unknown[] = {
      [](Snapshot& s) { s.joints->position(3) = kNaN; },
      [](Snapshot& s) { s.joints->position(2) += 0.16; },
      [](Snapshot& s) { s.joints->stamp -= 0.31; },
  };
  const Spoil worth_holding[] = {
      [](Snapshot& s) { s.endpoint->received -= 0.11; },  [](Snapshot& s) { s.endpoint->force.z() = kNaN; },
      [](Snapshot& s) { s.endpoint->force.setZero(); },   [](Snapshot& s) { s.endpoint->stamp -= 0.31; },
      [](Snapshot& s) { s.collision->collision = true; },
  };
  for (const Spoil& spoil_joints : unknown) {
    for (const Spoil& spoil_more : worth_holding) {
      Rules rules;
      ASSERT_THAT(rules.at(1.0), IsNothing());
      const std::optional<Fault> fault = rules.at(1.01, [&](Snapshot& s) {
        spoil_joints(s);
        spoil_more(s);
      });
      EXPECT_THAT(fault, IsFault("", AllowedAction::silence));
    }
  }
}

TEST(AnArmBesideTheArea, IsNotRaisedEvenIfItsReflexStoppedIt) {
  Snapshot seen = sound(1.0, pose());
  EXPECT_THAT(Rules().check(seen, {0.1, 0.1, -0.05}), IsFault("below the floor", AllowedAction::hold));
  seen.collision->collision = true;
  EXPECT_THAT(Rules().check(seen, {0.1, 0.1, -0.05}), IsFault("below the floor", AllowedAction::hold));
}

TEST(ASoundRobot, BreaksNoRule) {
  Rules rules;
  rules.set_tare(kZero);
  for (double now = 1.0; now < 3.0; now += 0.01) {
    rules.record_command(now, pose());
    ASSERT_THAT(rules.at(now), IsNothing());
  }
  EXPECT_THAT(rules.at(3.0, [](Snapshot& s) { s.state->error = true; }), IsNothing())
      << "enabled it moves all the same";
}

TEST(ASoundRobot, MayHaveAnotherClockThatGoesALittleFasterAndForgetACollisionStream) {
  Rules rules;
  for (double now = 1.0; now < 4.0 * 3600.0; now += 1.0) {
    rules.begin();  // read once per second, between motions
    ASSERT_THAT(rules.at(now,
                         [&](Snapshot& s) {
                           s.joints->stamp = s.endpoint->stamp = 12345.0 + 0.9999 * now;  // 1.4 s in four hours
                           s.collision.reset();
                         }),
                IsNothing())
        << now;
  }
}

/// Simulates collision messages every `period` seconds that stop. Returns whether this was noticed within two seconds.
bool noticed_silence_of_collisions(double period) {
  Rules rules;
  double last = 1.0;
  for (double now = 1.0; now < 7.0; now += 0.01) {
    if (now < 5.0 && now - last >= period) last = now;
    const std::optional<Fault> fault = rules.at(now, [&](Snapshot& s) { s.collision->received = last; });
    if (!fault) continue;
    EXPECT_THAT(fault, IsFault("collision_detection_state of the left arm did not arrive", AllowedAction::hold));
    return true;
  }
  return false;
}

TEST(AStreamOfCollisions, MustGoOnIfItCameAgainAndAgain) {
  EXPECT_TRUE(noticed_silence_of_collisions(0.02));
  EXPECT_FALSE(noticed_silence_of_collisions(1.5)) << "it is sent when it changes";
}

TEST(ADisabledRobot, IsFitWhereNothingMoves) {
  Snapshot seen = sound(1.0, pose());
  seen.state->enabled = false;
  seen.state->ready = false;
  EXPECT_TRUE(MotionGuard::check_readiness(seen, true));
  EXPECT_FALSE(MotionGuard::check_readiness(seen, false));
}

TEST(AForce, StopsAfterThreeReadingsBeyondTheLimitAndSidewaysHalfAsMuchAgain) {
  for (const Eigen::Vector3d& push : {Eigen::Vector3d(0, 0, 14.5), Eigen::Vector3d(0, 0, -14.5),
                                      Eigen::Vector3d(21.5, 0, 0), Eigen::Vector3d(15.5, 15, 7)}) {
    Rules rules;
    rules.set_tare(kZero);
    std::optional<Fault> fault;
    for (int i = 1; i <= 3; ++i) {
      EXPECT_THAT(fault, IsNothing()) << "one or two samples may be noise";
      fault = rules.at(1.0 + 0.01 * i, [&](Snapshot& s) { s.endpoint->force = kZero + (1.0 + 0.001 * i) * push; });
    }
    EXPECT_THAT(fault, IsFault("more than force_stop allows", AllowedAction::retreat));
  }
}

/// Returns whether a force, added to the zero as a function of the period, stops an arm within `periods` periods.
bool stopped(MotionGuard::ZeroMode zero, int periods, const std::function<Eigen::Vector3d(int)>& force) {
  Rules rules;
  rules.set_tare(kZero, zero);
  for (int i = 1; i <= periods; ++i) {
    if (rules.at(1.0 + 0.01 * i, [&](Snapshot& s) { s.endpoint->force += force(i); })) return true;
  }
  return false;
}

TEST(AForce, SidewaysOfAnArmWhoseJointsRubStopsNoTapButStopsTravel) {
  const auto rubs = [](int) { return Eigen::Vector3d(17, 9, 0); };
  EXPECT_FALSE(stopped(MotionGuard::ZeroMode::stays, 5, rubs));
  EXPECT_TRUE(stopped(MotionGuard::ZeroMode::follows, 5, rubs));
}

TEST(AForce, WhoseZeroFollowsStopsWhenItRisesFastAndNotWhenItDrifts) {
  for (const double rise : {10.0, 50.0}) {  // N/s
    const auto rises = [rise](int period) { return Eigen::Vector3d(0.01 * rise * period, 0, 0); };
    EXPECT_EQ(stopped(MotionGuard::ZeroMode::follows, 300, rises), rise > 20.0);
  }
}

TEST(AForce, CountsFromTheTareOnly) {
  Rules rules;
  for (const double now : {1.0, 1.01, 1.02}) {
    EXPECT_THAT(rules.at(now, [](Snapshot& s) { s.endpoint->force.z() += 40.0; }), IsNothing()) << "nothing is tared";
  }
}

TEST(TheWorkspace, EndsTenCentimetresBesideTheAreaAndAtFloorAndCeiling) {
  EXPECT_EQ(kSpace.breach({-0.09, 0.32, 0.0}), "");
  EXPECT_THAT(kSpace.breach({-0.11, 0.1, 0.1}), HasSubstr("more than 10 cm outside the area"));
  EXPECT_THAT(kSpace.breach({0.1, 0.34, 0.1}), HasSubstr("the tip is at (10.0, 34.0, 10.0) cm of the scene"));
  EXPECT_THAT(kSpace.breach({0.1, 0.1, -0.031}), HasSubstr("below the floor of -3.0 cm"));
  EXPECT_THAT(kSpace.breach({0.1, 0.1, 0.44}), HasSubstr("above the ceiling of 43.5 cm"));
  EXPECT_NE(kSpace.breach({kNaN, 0.1, 0.1}), "");
  EXPECT_NE(kSpace.breach({0.1, 0.1, kNaN}), "");
}

/// Simulates a ramp of joint s1 at `speed` (rad/s) while the arm is where it was sent at time `follows` (s). Returns
/// when a fault that contains `words` occurred, or 0.
double noticed(double speed, const std::function<double(double now)>& follows, const char* words = "") {
  Rules rules;
  for (double now = 0.0; now < 4.0; now += 0.01) {
    const auto ramp = [&](double time) {
      Joints out = pose();
      out(1) += speed * std::max(0.0, time);
      return out;
    };
    rules.record_command(now, ramp(now));
    const std::optional<Fault> fault = rules.at(now, nullptr, ramp(follows(now)));
    if (!fault) continue;
    EXPECT_THAT(fault, IsFault("the arm does not follow", AllowedAction::hold));
    EXPECT_THAT(fault->reason, HasSubstr(words));
    return now;
  }
  return 0.0;
}

TEST(AnArm, MayTrailItsSetPointByFourTenthsOfASecond) {
  for (const double speed : {0.0, 0.1, 0.3, kJointSpeed}) {
    EXPECT_EQ(noticed(speed, [](double now) { return now - 0.4; }), 0.0) << speed;
  }
}

TEST(AnArm, ThatDoesNotFollowIsNoticed) {
  const auto stuck = [](double now) { return std::min(now, 1.0); };
  const char* blocked = "deg from its target: check what blocks it";
  const double slow = noticed(0.1, stuck, blocked);
  EXPECT_GT(slow, 1.0);
  EXPECT_LT(slow, 3.0);
  const double fast = noticed(0.4, stuck, blocked);
  EXPECT_GT(fast, 1.0);
  EXPECT_LT(fast, 1.6);
}

TEST(AnArm, ThatFollowsAtHalfTheSpeedIsToldByThatAndWhatToSet) {
  const double half = noticed(
      0.4, [](double now) { return 0.5 * now; },
      " deg/s instead of 23: set its speed ratio to 0.3, a Baxter's default, on /robot/limb/left/set_speed_ratio, or "
      "lower motion.travel_speed");
  EXPECT_GT(half, 0.5);
  EXPECT_LT(half, 1.5);
}

TEST(BeginningAnew, ForgetsWhatWasSentAndFelt) {
  Rules rules;
  rules.set_tare(Eigen::Vector3d::Zero());
  rules.record_command(1.0, pose());
  ASSERT_THAT(rules.at(1.0), IsNothing());
  rules.begin();
  EXPECT_FALSE(rules.last_sent());
  Joints elsewhere = pose();
  elsewhere(0) += 0.5;  // moved by hand meanwhile
  EXPECT_THAT(rules.at(
                  9.0, [](Snapshot& s) { s.endpoint->force.z() = 30.0; }, elsewhere),
              IsNothing());
}

}  // namespace
}  // namespace palpate::baxter
