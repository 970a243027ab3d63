// SPDX-License-Identifier: MIT
// Every rule under which the arm may move: just kept, and just broken.
#include "baxter/watch_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>

namespace palpate::baxter {
namespace {

using test::kInside;
using test::kSpace;
using test::pose;
using test::sound;
using testing::HasSubstr;
using Then = Fault::Then;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One thing that is wrong with a robot, and what is to be said and done about it.
struct Wrong {
  const char* name;
  std::function<void(Snapshot&)> spoil;
  const char* reason;
  Then then;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.reason; }

class BrokenRule : public testing::TestWithParam<Wrong> {};

TEST_P(BrokenRule, StopsTheArmAndSaysWhy) {
  Watch watch(kSpace, 14.0);
  ASSERT_FALSE(watch.look(sound(1.0, pose()), kInside)) << "nothing is wrong before";
  Snapshot seen = sound(1.01, pose());
  GetParam().spoil(seen);
  const std::optional<Fault> fault = watch.look(seen, kInside);
  ASSERT_TRUE(fault);
  EXPECT_THAT(fault->reason, HasSubstr(GetParam().reason));
  EXPECT_EQ(fault->then, GetParam().then);
  EXPECT_TRUE(fault->ends_run);
}

INSTANTIATE_TEST_SUITE_P(
    OfTheRobot, BrokenRule,
    testing::Values(
        Wrong{"EmergencyStop", [](Snapshot& s) { s.state->estop_button = StateReading::Button::pressed; },
              "the emergency stop is pressed: release it", Then::silence},
        Wrong{"EmergencyStopReleased", [](Snapshot& s) { s.state->estop_button = StateReading::Button::released; },
              "was pressed and is released: reset it (rosrun", Then::silence},
        Wrong{
            "Error",
            [](Snapshot& s) {
              s.state->error = true;
              s.state->enabled = false;
            },
            "reports an error and is disabled: see its screen, then reset it (rosrun baxter_tools enable_robot.py -r)",
            Then::silence},
        Wrong{"Stopped", [](Snapshot& s) { s.state->stopped = true; }, "the robot is stopped", Then::silence},
        Wrong{"Disabled", [](Snapshot& s) { s.state->enabled = false; }, "the robot is disabled: enable it",
              Then::silence},
        Wrong{"Tucked",
              [](Snapshot& s) {
                s.state->enabled = false;
                s.joints->position(1) = -2.07;
              },
              "its arm is tucked (left_s1 at -118.6 deg): untuck it", Then::silence},
        Wrong{"NotReady", [](Snapshot& s) { s.state->ready = false; }, "not ready", Then::silence},
        Wrong{"OldState", [](Snapshot& s) { s.state->received -= 0.51; }, "/robot/state did not come for 0.51 s",
              Then::silence},
        Wrong{"TwoSendersOfState", [](Snapshot& s) { s.state_senders.push_back("/mock"); },
              "/robot/state comes from more than one node, /realtime_loop and /mock", Then::silence},
        Wrong{"TwoSendersOfJoints", [](Snapshot& s) { s.joint_senders.push_back("/mock"); },
              "joints of the left arm come from more than one node", Then::silence},
        Wrong{"Malformed", [](Snapshot& s) { s.malformed = "joint_states has 17 names and 3 positions"; },
              "17 names and 3 positions", Then::silence},
        Wrong{"OldJoints", [](Snapshot& s) { s.joints->received -= 0.11; }, "joint_states of the left arm did not come",
              Then::silence},
        Wrong{"OldEndpoint", [](Snapshot& s) { s.endpoint->received -= 0.11; },
              "endpoint_state of the left arm did not", Then::hold},
        Wrong{"JointIsNoNumber", [](Snapshot& s) { s.joints->position(3) = kNaN; }, "a position that is no number",
              Then::silence},
        Wrong{"ForceIsNoNumber", [](Snapshot& s) { s.endpoint->force.z() = kNaN; },
              "a force or a place that is no number", Then::hold},
        Wrong{"NoForce", [](Snapshot& s) { s.endpoint->force.setZero(); }, "exactly zero", Then::hold},
        Wrong{"StampsLag", [](Snapshot& s) { s.endpoint->stamp -= 0.31; },
              "endpoint_state comes with stamps 0.31 s older", Then::hold},
        Wrong{"JointStampsLag", [](Snapshot& s) { s.joints->stamp -= 0.31; },
              "joint_states comes with stamps 0.31 s older", Then::silence},
        Wrong{"Jump", [](Snapshot& s) { s.joints->position(2) += 0.07; }, "/robot/joint_states jumped by 4.0 deg",
              Then::silence},
        Wrong{"CommandedByAnother", [](Snapshot& s) { s.commanders = {"/palpate_2"}; },
              "the arm is commanded by /palpate_2, too", Then::silence},
        Wrong{"StoppedByAProgram",
              [](Snapshot& s) {
                s.state->stopped = true;
                s.state->estop_button = StateReading::Button::unknown;
              },
              "a program stopped the robot (/robot/set_super_stop)", Then::silence},
        Wrong{"Reflex", [](Snapshot& s) { s.collision->collision = true; }, "the arm's own reflex stopped it",
              Then::retreat}),
    [](const auto& wrong) { return std::string(wrong.param.name); });

TEST(AJoint, BeyondItsLimitIsNamed) {
  Watch watch(kSpace, 14.0);
  Joints joints = pose();
  joints(3) = 2.62;
  const std::optional<Fault> fault = watch.look(sound(1.0, joints), kInside);
  ASSERT_TRUE(fault);
  EXPECT_THAT(fault->reason, HasSubstr("left_e1 is at 150.1 deg, beyond its limit"));
  EXPECT_EQ(fault->then, Then::hold);
}

TEST(JointsThatAreNotKnown, AreNotHeldWhateverElseIsWrong) {
  const std::vector<std::function<void(Snapshot&)>> unknown = {
      [](Snapshot& s) { s.joints->position(3) = kNaN; },
      [](Snapshot& s) { s.joints->position(2) += 0.16; },
      [](Snapshot& s) { s.joints->stamp -= 0.31; },
  };
  const std::vector<std::function<void(Snapshot&)>> worth_holding = {
      [](Snapshot& s) { s.endpoint->received -= 0.11; },  [](Snapshot& s) { s.endpoint->force.z() = kNaN; },
      [](Snapshot& s) { s.endpoint->force.setZero(); },   [](Snapshot& s) { s.endpoint->stamp -= 0.31; },
      [](Snapshot& s) { s.collision->collision = true; },
  };
  for (const auto& spoil_joints : unknown) {
    for (const auto& spoil_more : worth_holding) {
      Watch watch(kSpace, 14.0);
      ASSERT_FALSE(watch.look(sound(1.0, pose()), kInside));
      Snapshot seen = sound(1.01, pose());
      spoil_joints(seen);
      spoil_more(seen);
      const std::optional<Fault> fault = watch.look(seen, kInside);
      ASSERT_TRUE(fault);
      EXPECT_EQ(fault->then, Then::silence) << fault->reason;
    }
  }
}

TEST(AnArmBesideTheArea, IsNotRaisedEvenIfItsReflexStoppedIt) {
  Watch watch(kSpace, 14.0);
  Snapshot seen = sound(1.0, pose());
  seen.collision->collision = true;
  const std::optional<Fault> fault = watch.look(seen, {0.1, 0.1, -0.05});
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->then, Then::hold);
}

TEST(ASoundRobot, MayHaveAClockThatGoesALittleFaster) {
  Watch watch(kSpace, 14.0);
  for (double now = 1.0; now < 4.0 * 3600.0; now += 1.0) {
    Snapshot seen = sound(now, pose());
    seen.joints->stamp = seen.endpoint->stamp = 0.9999 * now;  // 1.4 s in four hours
    watch.begin();                                             // it is looked at once a second, between motions
    const std::optional<Fault> fault = watch.look(seen, kInside);
    ASSERT_FALSE(fault) << now << ": " << fault->reason;
  }
}

/// Lets the stream of collisions come every `period` seconds and then no more; whether that was noticed in two seconds.
bool noticed_silence_of_collisions(double period) {
  Watch watch(kSpace, 14.0);
  double last = 1.0;
  for (double now = 1.0; now < 7.0; now += 0.01) {
    if (now < 5.0 && now - last >= period) last = now;
    Snapshot seen = sound(now, pose());
    seen.collision->received = last;
    if (const std::optional<Fault> fault = watch.look(seen, kInside)) {
      EXPECT_THAT(fault->reason, HasSubstr("collision_detection_state of the left arm did not come"));
      EXPECT_EQ(fault->then, Then::hold);
      return true;
    }
  }
  return false;
}

TEST(AStreamOfCollisions, MustGoOnIfItCameAgainAndAgain) {
  EXPECT_TRUE(noticed_silence_of_collisions(0.02));
  EXPECT_FALSE(noticed_silence_of_collisions(1.5)) << "it is sent when it changes";
}

TEST(ASoundRobot, MayReportAnErrorWhileItIsEnabled) {
  Watch watch(kSpace, 14.0);
  Snapshot seen = sound(1.0, pose());
  seen.state->error = true;
  EXPECT_FALSE(watch.look(seen, kInside)) << "it moves all the same";
}

TEST(ASoundRobot, BreaksNoRule) {
  Watch watch(kSpace, 14.0);
  watch.set_tare(Eigen::Vector3d(0.3, -0.2, 1.0));
  for (double now = 1.0; now < 3.0; now += 0.01) {
    watch.sent(now, pose());
    const std::optional<Fault> fault = watch.look(sound(now, pose()), kInside);
    ASSERT_FALSE(fault) << fault->reason;
  }
}

TEST(ASoundRobot, MayHaveAnotherClockAndForgetACollisionStream) {
  Watch watch(kSpace, 14.0);
  Snapshot seen = sound(1.0, pose());
  seen.joints->stamp = seen.endpoint->stamp = 12345.0;
  seen.collision.reset();
  EXPECT_FALSE(watch.look(seen, kInside));
}

TEST(ADisabledRobot, IsFitWhereNothingMoves) {
  Snapshot seen = sound(1.0, pose());
  seen.state->enabled = false;
  seen.state->ready = false;
  EXPECT_TRUE(Watch::fit(seen, true));
  EXPECT_FALSE(Watch::fit(seen, false));
}

TEST(AFrozenForce, IsNoticedHalfASecondLater) {
  Watch watch(kSpace, 14.0);
  Snapshot frozen = sound(1.0, pose());
  double noticed = 0.0;
  for (double now = 1.0; now < 2.0 && noticed == 0.0; now += 0.01) {
    Snapshot seen = sound(now, pose());
    seen.endpoint->force = frozen.endpoint->force;
    if (const std::optional<Fault> fault = watch.look(seen, kInside)) {
      EXPECT_THAT(fault->reason, HasSubstr("the same force to the last digit"));
      EXPECT_EQ(fault->then, Then::hold);
      noticed = now;
    }
  }
  EXPECT_NEAR(noticed, 1.51, 0.015);
}

TEST(AForce, StopsAfterThreeReadingsBeyondTheLimitAndSidewaysHalfAsMuchAgain) {
  for (const Eigen::Vector3d& push : {Eigen::Vector3d(0, 0, 14.5), Eigen::Vector3d(0, 0, -14.5),
                                      Eigen::Vector3d(21.5, 0, 0), Eigen::Vector3d(15.5, 15, 7)}) {
    Watch watch(kSpace, 14.0);
    const Eigen::Vector3d zero(0.3, -0.2, 1.0);
    watch.set_tare(zero);
    std::optional<Fault> fault;
    for (int i = 1; i <= 3; ++i) {
      EXPECT_FALSE(fault) << "one or two samples may be noise";
      Snapshot seen = sound(1.0 + 0.01 * i, pose());
      seen.endpoint->force = zero + (1.0 + 0.001 * i) * push;
      fault = watch.look(seen, kInside);
    }
    ASSERT_TRUE(fault);
    EXPECT_THAT(fault->reason, HasSubstr("more than force_stop allows"));
    EXPECT_EQ(fault->then, Then::retreat);
  }
}

TEST(AForce, SidewaysOfAnArmWhoseJointsRubStopsNoTapButStopsTravel) {
  for (const auto zero : {Watch::Zero::stays, Watch::Zero::follows}) {
    Watch watch(kSpace, 14.0);
    watch.set_tare(Eigen::Vector3d(0.3, -0.2, 1.0), zero);
    bool stopped = false;
    for (int i = 1; i <= 5; ++i) {
      Snapshot seen = sound(1.0 + 0.01 * i, pose());
      seen.endpoint->force += Eigen::Vector3d(17, 9, 0);
      stopped = stopped || watch.look(seen, kInside);
    }
    EXPECT_EQ(stopped, zero == Watch::Zero::follows);
  }
}

TEST(AForce, WhoseZeroFollowsStopsWhenItRisesFastAndNotWhenItDrifts) {
  const auto stopped = [](double rise) {  // N/s
    Watch watch(kSpace, 14.0);
    for (int i = 0; i < 300; ++i) {
      Snapshot seen = sound(1.0 + 0.01 * i, pose());
      if (i == 0) watch.set_tare(seen.endpoint->force, Watch::Zero::follows);
      seen.endpoint->force.x() += 0.01 * rise * i;
      if (watch.look(seen, kInside)) return true;
    }
    return false;
  };
  EXPECT_FALSE(stopped(10.0));
  EXPECT_TRUE(stopped(50.0));
}

TEST(AForce, CountsFromTheTareOnly) {
  Watch watch(kSpace, 14.0);
  for (const double now : {1.0, 1.01, 1.02}) {
    Snapshot seen = sound(now, pose());
    seen.endpoint->force.z() += 40.0;
    EXPECT_FALSE(watch.look(seen, kInside)) << "nothing is tared yet";
  }
}

TEST(TheWorkspace, EndsTenCentimetresBesideTheAreaAndAtFloorAndCeiling) {
  EXPECT_EQ(kSpace.breach({-0.09, 0.32, 0.0}), "");
  EXPECT_THAT(kSpace.breach({-0.11, 0.1, 0.1}), HasSubstr("more than 10 cm beside the area"));
  EXPECT_THAT(kSpace.breach({0.1, 0.34, 0.1}), HasSubstr("the tip is at (10.0, 34.0, 10.0) cm of the scene"));
  EXPECT_THAT(kSpace.breach({0.1, 0.1, -0.031}), HasSubstr("below the floor of -3.0 cm"));
  EXPECT_THAT(kSpace.breach({0.1, 0.1, 0.44}), HasSubstr("above the ceiling of 43.5 cm"));
  EXPECT_NE(kSpace.breach({kNaN, 0.1, 0.1}), "");
  EXPECT_NE(kSpace.breach({0.1, 0.1, kNaN}), "");
  Watch watch(kSpace, 14.0);
  const std::optional<Fault> fault = watch.look(sound(1.0, pose()), {0.1, 0.1, -0.05});
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->then, Then::hold);
}

/// Sends a ramp of joint s1 at `speed` (rad/s) while the arm is where `follows` says (s) it was sent to; when that was
/// noticed, or 0.
double noticed(double speed, const std::function<double(double now)>& follows) {
  Watch watch(kSpace, 14.0);
  for (double now = 0.0; now < 4.0; now += 0.01) {
    const auto ramp = [&](double time) {
      Joints out = pose();
      out(1) += speed * std::max(0.0, time);
      return out;
    };
    watch.sent(now, ramp(now));
    if (const std::optional<Fault> fault = watch.look(sound(now, ramp(follows(now))), kInside)) {
      EXPECT_THAT(fault->reason, HasSubstr("the arm does not follow"));
      EXPECT_EQ(fault->then, Then::hold);
      return now;
    }
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
  const double slow = noticed(0.1, stuck);
  EXPECT_GT(slow, 1.0);
  EXPECT_LT(slow, 3.0);
  const double fast = noticed(0.4, stuck);
  EXPECT_GT(fast, 1.0);
  EXPECT_LT(fast, 1.6);
}

TEST(BeginningAnew, ForgetsWhatWasSentAndFelt) {
  Watch watch(kSpace, 14.0);
  watch.set_tare(Eigen::Vector3d::Zero());
  watch.sent(1.0, pose());
  ASSERT_FALSE(watch.look(sound(1.0, pose()), kInside));
  watch.begin();
  EXPECT_FALSE(watch.last_sent());
  Joints elsewhere = pose();
  elsewhere(0) += 0.5;  // moved by hand meanwhile
  Snapshot seen = sound(9.0, elsewhere);
  seen.endpoint->force.z() = 30.0;
  EXPECT_FALSE(watch.look(seen, kInside));
}

}  // namespace
}  // namespace palpate::baxter
