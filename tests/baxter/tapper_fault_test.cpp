// SPDX-License-Identifier: MIT
// Faults in a tap, and the resulting state of the arm.
#include "baxter/body_bench.hpp"
#include "baxter/fault_cases.hpp"
#include "baxter/spring_desk.hpp"
#include "baxter/tapper_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using fake_baxter::Body;
using fake_baxter::FaultKind;
using test::fake_options;
using test::kHover;
using test::kOnDesk;
using test::kOnObject;
using Bench = test::TapperBench;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ATap, InterruptedIsAbortedAndTheArmRaised) {
  for (const double at : {0.13, 0.12, 0.1095}) {  // during the descent, and while pressing
    Bench bench;
    bench.robot.every_period = [&] {
      if (bench.tip() < at) bench.interrupted = true;
    };
    const tapping::HeightResult contact = bench.tap(kOnObject);
    EXPECT_EQ(contact.outcome, Outcome::aborted);
    EXPECT_EQ(contact.reason, "interrupted; the arm was raised to the height of travel");
    EXPECT_FALSE(contact.ends_run);
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
  }
}

TEST(ATap, WithTheForceOfTheOtherSignIsStoppedAndSaysWhatToSet) {
  Bench bench(test::with([](BaxterOptions& o) { o.force_sign = BaxterOptions::ForceSign::positive; }));
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr("force_sign is wrong"));
  EXPECT_NEAR(bench.tip(), kHover, 0.01);
}

class TroubleInATap : public testing::TestWithParam<palpate::test::FaultCase> {};

void expect_safe(const palpate::test::FaultCase& trouble, fake_baxter::MechanicsOptions::Type arm) {
  Bench bench(fake_options(), [&](test::BodyOptions& body) { body.mechanics.type = arm; });
  bench.check();
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  bench.robot.body.inject(fake_baxter::parse_fault(trouble.fault),
                          {1, 0.125});  // during the descent to the object at 11 cm
  double since = 0.0;
  double lowest = 1.0;
  bench.robot.every_period = [&] {
    if (since == 0.0 && bench.robot.body.faulty()) since = bench.robot.body.now();
    lowest = std::min(lowest, bench.tip());
  };
  const tapping::HeightResult contact = bench.tap(kOnObject);
  const double took = bench.robot.body.now() - since;
  ASSERT_GT(since, 0.0) << "it never happened";
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr(trouble.reason));
  EXPECT_EQ(contact.ends_run, trouble.ends_run);
  EXPECT_LT(took, trouble.ends_run ? 5.0 : 10.0);
  // Without set-points the firmware does not move the arm.
  const double left_at = bench.tip();
  for (int i = 0; i < 300; ++i) bench.robot.body.step();
  EXPECT_NEAR(bench.tip(), left_at, 0.005) << "it stands";
  if (trouble.raised) {
    EXPECT_THAT(contact.reason,
                testing::AnyOf(EndsWith("the arm was raised to the height of travel"), HasSubstr("its zero moved")));
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
  } else {
    EXPECT_THAT(contact.reason, testing::AnyOf(HasSubstr("no more commands are sent"), HasSubstr("the arm holds")));
    EXPECT_LT(bench.tip(), 0.127);
  }
  EXPECT_LT(bench.robot.body.pressing(), Body::kReflex);
}

TEST_P(TroubleInATap, LeavesTheArmSafeWithinFiveSeconds) {
  expect_safe(GetParam(), fake_baxter::MechanicsOptions::Type::lagged);
}

TEST_P(TroubleInATap, LeavesTheArmWithMassesAsSafe) {
  expect_safe(GetParam(), fake_baxter::MechanicsOptions::Type::springs);
}

INSTANTIATE_TEST_SUITE_P(OnTheWayDown, TroubleInATap, testing::ValuesIn(palpate::test::kFaultCases),
                         [](const auto& trouble) { return name_of(trouble.param); });

TEST(AFault, OfAnArmThatStandsWhereItIsSentDownSlowlyIsNoticedBeforeItCanJump) {
  for (const double filter : {0.0, 0.1, 0.2}) {  // s, filter of the force: a late detection makes the descent slow
    Bench bench(fake_options(),
                [](test::BodyOptions& body) { body.mechanics.type = fake_baxter::MechanicsOptions::Type::springs; });
    if (filter > 0.0) bench.robot.body.inject({FaultKind::wrench_filter, filter, {}});
    bench.check();
    ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
    double stood = 0.0;
    bench.robot.every_period = [&] {
      if (stood > 0.0 || bench.tip() > 0.125) return;
      stood = bench.robot.body.now();
      bench.robot.body.inject({FaultKind::drop_commands, 5.0, {}});
    };
    const tapping::HeightResult contact = bench.tap(kOnObject);
    ASSERT_GT(stood, 0.0);
    EXPECT_THAT(contact.reason, HasSubstr("the arm does not follow: it stays ")) << filter;
    EXPECT_TRUE(contact.ends_run) << filter;
    EXPECT_LT(bench.robot.body.now() - stood, 2.5 + 0.5) << filter << ": and the joints are held for 0.5 s";
  }
}

TEST(AFault, ThatIsFollowedByAnEmergencyStopEndsTheHold) {
  Bench bench;
  bench.robot.body.inject({FaultKind::kill_endpoint, 0.0, {}}, {1, 0.125});
  double pressed = 0.0;
  std::size_t sent = 0;
  bench.robot.every_period = [&] {
    if (!bench.robot.body.faulty()) return;
    if (pressed == 0.0) pressed = bench.robot.body.now() + 0.2;  // 0.1 s until the detection
    if (sent == 0 && bench.robot.body.now() >= pressed) {
      bench.robot.body.inject({FaultKind::estop, 1000.0, {}});
      sent = bench.robot.commands.size();
    }
  };
  const tapping::HeightResult contact = bench.tap(kOnObject);
  ASSERT_GT(sent, 0U);
  EXPECT_LE(bench.robot.commands.size(), sent + 1) << "an arm under an emergency stop is sent nothing";
  EXPECT_THAT(contact.reason, StartsWith("endpoint_state of the left arm did not arrive"));
  EXPECT_THAT(
      contact.reason,
      EndsWith(
          "no more commands are sent, the arm stays where it is: the emergency stop is pressed: release it, then reset "
          "it (rosrun baxter_tools enable_robot.py -r) and enable it (rosrun baxter_tools enable_robot.py -e)"));
}

TEST(AFault, BetweenTwoTapsSendsNothing) {
  Bench bench;
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  bench.robot.body.inject({FaultKind::kill_endpoint, 0.0, {}});
  bench.robot.wait_until(bench.robot.body.now() + 1.0);
  const std::size_t sent = bench.robot.commands.size();
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_THAT(contact.reason, StartsWith("endpoint_state of the left arm did not arrive"));
  EXPECT_TRUE(contact.ends_run);
  EXPECT_EQ(bench.robot.commands.size(), sent);
}

TEST(AFault, ThatNobodyThoughtOfIsRecordedAndNothingMoreIsSent) {
  Bench bench;
  std::size_t sent = 0;
  bench.robot.every_period = [&] {
    if (bench.tip() > 0.125 || sent > 0) return;
    sent = bench.robot.commands.size();
    throw std::runtime_error("out of memory");
  };
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_EQ(contact.reason, "out of memory; no more commands are sent, the arm stays where it is");
  EXPECT_EQ(bench.robot.commands.size(), sent);
}

TEST(ATap, InterruptedWhileItIsPlannedAsksForNoOtherPoseAndSendsNothing) {
  Bench bench(test::asking());
  bench.check();
  const ArmKinematics gripper({0, 0, 0.025});
  bench.robot.answer = [&](const Pose& pose, const Joints& seed) {
    bench.interrupted = true;
    return gripper.solve(pose, seed);
  };
  const int before = bench.robot.asked;
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.reason, "interrupted; no more commands are sent, the arm stays where it is");
  EXPECT_FALSE(contact.ends_run);
  EXPECT_EQ(bench.robot.asked, before + 1);
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(AFault, RaisesTheArmWithoutTheRobotsInverseKinematics) {
  Bench bench(test::asking());
  bench.robot.every_period = [&] {
    if (bench.tip() > 0.12) return;
    bench.interrupted = true;
    bench.robot.answer = test::silent_service;
  };
  const tapping::HeightResult contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.reason, "interrupted; the arm was raised to the height of travel");
  EXPECT_NEAR(bench.tip(), kHover, 0.01);
}

/// Returns the largest force in N of an arm with springs on 8 kN/m, with a fault that begins at 2 N.
double hardest_press(const char* fault, std::string& reason) {
  test::SpringDesk desk(8000.0);
  double peak = 0.0;
  desk.robot.every_period = [&] {
    peak = std::max(peak, desk.robot.body.arm().peak);
    if (desk.robot.body.pressing() > 2.0 && !desk.robot.body.faulty()) desk.inject(fault);
  };
  const tapping::HeightResult contact = desk.tap(kOnDesk);
  reason = contact.reason;
  EXPECT_TRUE(contact.ends_run);
  desk.wait(3.0);
  return peak;
}

TEST(AFault, OfTheForceAtTheMomentOfAContactIsNoticedBeforeTheArmPressesHard) {
  const std::pair<const char*, const char*> cases[] = {{"freeze_endpoint", "exactly the same force"},
                                                       {"second_sender=endpoint", "comes from more than one node"}};
  for (const auto& [fault, words] : cases) {
    std::string reason;
    EXPECT_LT(hardest_press(fault, reason), 12.0) << fault;
    EXPECT_THAT(reason, HasSubstr(words));
  }
}

TEST(ATap, FeelsAForceThatIsRenewedWithEverySecondMessageOnly) {
  Bench bench;
  bench.robot.body.inject(fake_baxter::parse_fault("slow_force=2"));
  bench.check();
  bench.touch(kOnObject);
}

TEST(Travel, OfARobotAtHalfItsSpeedSaysWhatToSet) {
  Bench bench(fake_options(), [](test::BodyOptions& body) { body.speed_ratio = 0.15; });
  const tapping::HeightResult contact = bench.tap({0.21, 0.02});
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr("set its speed ratio to 0.3, a Baxter's default, on "
                                        "/robot/limb/left/set_speed_ratio, or lower motion.travel_speed"));
}

TEST(Travel, StopsWhenItMeetsSomething) {
  Bench bench;
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  double met = 0.0;
  bench.robot.spoil = [&](Snapshot& seen) {
    if (bench.tip() < kHover - 0.01 || bench.robot.body.tip().x() < 0.08) return;
    if (met == 0.0) met = seen.now;
    seen.endpoint->force.x() += 60.0 * (seen.now - met);
  };
  const tapping::HeightResult contact = bench.tap({0.2, 0.2});
  ASSERT_GT(met, 0.0);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr("more than force_stop allows"));
  EXPECT_TRUE(contact.ends_run);
  EXPECT_LT(bench.robot.body.tip().x(), 0.19);
}

TEST(Travel, StopsWhenAnotherProgramCommandsTheArm) {
  Bench bench;
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  std::size_t sent = 0;
  bench.robot.spoil = [&](Snapshot& seen) {
    if (bench.robot.body.tip().x() < 0.08) return;
    if (sent == 0) sent = bench.robot.commands.size();
    seen.commanders = {"/palpate_2"};
  };
  const tapping::HeightResult contact = bench.tap({0.2, 0.2});
  EXPECT_THAT(contact.reason, StartsWith("the arm is also commanded by /palpate_2: end that program first"));
  EXPECT_TRUE(contact.ends_run);
  EXPECT_EQ(bench.robot.commands.size(), sent) << "two that command the arm make it tremble";
}

}  // namespace
}  // namespace palpate::baxter
