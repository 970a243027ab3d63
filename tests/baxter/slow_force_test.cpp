// SPDX-License-Identifier: MIT
// Taps of robots that rarely renew their force or become too slow during a tap, and taps of very soft objects.
#include "baxter/spring_desk.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

namespace palpate::baxter {
namespace {

using fake_baxter::Body;
using fake_baxter::FaultKind;
using fake_baxter::parse_fault;
using test::fake_options;
using test::SpringDesk;
using testing::AnyOf;
using testing::ContainsRegex;
using testing::HasSubstr;

constexpr double kHard = 20000.0;  // N/m

TEST(AForce, ThatIsRenewedTwentyOrTenTimesASecondIsTappedWith) {
  for (const int every : {5, 10}) {
    for (const double stiffness : {1000.0, kHard}) {
      SpringDesk desk(stiffness);
      desk.inject(fmt::format("slow_force={}", every));
      desk.tapper.check();
      for (int i = 0; i < 3; ++i) {
        const tapping::HeightResult contact = desk.tap();
        EXPECT_EQ(contact.outcome, Outcome::contact) << every << ": " << contact.reason;
        EXPECT_NEAR(contact.height, 0.0, 0.003) << every;
        EXPECT_LT(desk.peak, Body::kReflex) << every;
      }
    }
  }
}

// Without measurements the arm descends as slowly as its renewals require, not at the least speed of a measured arm.
TEST(AForce, ThatIsRenewedEightOrTenTimesASecondIsExpectedWithinTheBoundAtTheFirstTap) {
  BaxterOptions options = fake_options();
  options.scene_pose.corner[0] = 0.4;  // 8.4 kN/m, stiffer than any position of a usual area
  for (const int every : {10, 12}) {
    SpringDesk desk(kHard, options);
    desk.inject(fmt::format("slow_force={}", every));
    desk.tapper.check();
    EXPECT_EQ(desk.tap().outcome, Outcome::contact) << every;
    EXPECT_LT(desk.peak, Body::kReflex) << every;
    std::smatch found;
    const std::regex line("tap 1: ([0-9.]+) mm/s.*at most ([0-9.]+) N are expected");
    ASSERT_TRUE(std::regex_search(desk.notes, found, line)) << desk.notes;
    EXPECT_LT(std::stod(found[1]), 1e3 * ReactionTime::kSlowest) << "at a place where that matters";
    EXPECT_LE(std::stod(found[2]), ReactionTime::kGreatestForce + 0.05) << every << ": " << desk.notes;
  }
}

TEST(ARobot, ThatMayBeTooSlowIsRejectedBeforeItsFirstTapWithWhatIsAssumed) {
  BaxterOptions options = fake_options();
  options.scene_pose.corner[0] = 0.36;
  options.scene_pose.corner[1] = 0.2;  // even stiffer
  SpringDesk desk(kHard, options);
  desk.inject("slow_force=10");
  desk.inject("jitter=0.07");
  const tapping::HeightResult contact = desk.tap();
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason,
              HasSubstr("before the first measured contact it is assumed that a contact would be detected"));
  EXPECT_THAT(contact.reason, HasSubstr(" mm/s, but 1 mm/s are needed"));
  EXPECT_THAT(contact.reason, HasSubstr("choose a motion.threshold below 5.0 N"));
  EXPECT_GT(desk.lowest, 0.1) << "it did not come down";
}

TEST(AForce, ThatIsRenewedSeldomAndFreezesAtAContactIsFoundBeforeTheReflex) {
  for (const int every : {1, 2, 5, 10}) {
    SpringDesk desk(kHard);
    if (every > 1) desk.inject(fmt::format("slow_force={}", every));
    ASSERT_EQ(desk.tap().outcome, Outcome::contact) << every;
    desk.robot.body.inject({FaultKind::freeze_endpoint, 0.0, {}}, {1, 0.0002});
    const tapping::HeightResult contact = desk.tap();
    EXPECT_THAT(contact.reason, AnyOf(HasSubstr("exactly the same force"), HasSubstr("with a new force only")));
    EXPECT_LT(desk.peak, Body::kReflex) << every;
  }
}

TEST(AnArm, ThatPressesOnSomethingHardIsNotTakenForOneThatStands) {
  struct Case {
    const char* what;
    double speed, fine_speed, threshold, fine_threshold, filter;
    tapping::MotionOptions::Type type;
  };
  using Type = tapping::MotionOptions::Type;
  for (const Case& one : {Case{"slow", 0.002, 0.002, 5.0, 5.0, 0.0, Type::continuous},
                          Case{"late", 0.015, 0.015, 8.0, 8.0, 0.2, Type::continuous},
                          Case{"slow at the end", 0.015, 0.002, 5.0, 3.0, 0.0, Type::two_stage},
                          Case{"late in steps", 0.01, 0.01, 5.0, 5.0, 0.2, Type::paper}}) {
    BaxterOptions options = fake_options();
    options.motion.type = one.type;
    options.motion.speed = one.speed;
    options.motion.fine_speed = one.fine_speed;
    options.motion.threshold = one.threshold;
    options.motion.fine_threshold = one.fine_threshold;
    options.motion.timeout = 120.0;
    SpringDesk desk(kHard, options);
    if (one.filter > 0.0) desk.inject(fmt::format("wrench_filter={}", one.filter));
    for (int tap = 0; tap < 3; ++tap) {
      const tapping::HeightResult contact = desk.tap();
      EXPECT_EQ(contact.outcome, Outcome::contact) << one.what << ": " << contact.reason;
    }
  }
}

TEST(ARobot, WhoseForceIsRenewedTooSeldomForItsThresholdIsRejectedWithTheMeasuredFigure) {
  BaxterOptions options = fake_options();
  options.motion.threshold = 10.0;
  SpringDesk desk(kHard, options);
  desk.inject("slow_force=10");
  ASSERT_EQ(desk.tap().outcome, Outcome::contact) << "at 5 N, while nothing was measured";
  const tapping::HeightResult contact = desk.tap();
  EXPECT_THAT(contact.reason, ContainsRegex("^a contact would be detected after [45].. ms"));
  EXPECT_THAT(contact.reason, HasSubstr(" mm/s, but 2 mm/s are needed"));
  EXPECT_GT(desk.lowest, 0.1) << "it did not come down";
}

TEST(ARobot, ThatBecomesTooSlowOnTheWayDownIsStoppedAndRaisedWithTheMeasuredFigure) {
  BaxterOptions options = fake_options();
  options.motion.threshold = 10.0;
  SpringDesk desk(kHard, options);
  ASSERT_EQ(desk.tap().outcome, Outcome::contact);
  // The first active fault in the list counts.
  for (const auto& [delay, height] : {std::pair{0.27, 0.06}, {0.18, 0.08}, {0.09, 0.1}}) {
    desk.robot.body.inject({FaultKind::delay, delay, {}}, {1, height});
  }
  const tapping::HeightResult contact = desk.tap();
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr(" mm/s, but 2 mm/s are needed"));
  EXPECT_THAT(contact.reason, HasSubstr("the arm was raised to the height of travel"));
  EXPECT_TRUE(contact.ends_run);
  EXPECT_GT(desk.lowest, 0.03) << "it did not come down further";
}

TEST(SomethingSoft, BelowThePromisedStiffnessIsPressedForLessThan25SecondsAndToldOrFound) {
  for (const double stiffness : {250.0, 300.0, 400.0}) {
    // The floor is far below the desk, so only the force ends the descent.
    BaxterOptions options = fake_options();
    options.motion.overrun = 0.1;
    SpringDesk desk(stiffness, options);
    for (int i = 0; i < 2; ++i) {
      const tapping::HeightResult contact = desk.tap();
      const double took = desk.robot.body.now() - desk.touched.value();
      if (contact.outcome != Outcome::contact) {
        EXPECT_THAT(contact.reason, HasSubstr("a contact is too soft: its force rises by 1")) << stiffness;
        EXPECT_FALSE(contact.ends_run);
      }
      EXPECT_LT(took, 25.0) << stiffness;
      EXPECT_LT(desk.peak, 14.0) << stiffness;
    }
  }
}

TEST(SomethingSoft, BelowThePromisedStiffnessIsToldByThePapersMotionToo) {
  BaxterOptions options = fake_options();
  options.motion.type = tapping::MotionOptions::Type::paper;
  options.motion.overrun = 0.1;
  SpringDesk desk(250.0, options);
  const tapping::HeightResult contact = desk.tap();
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr("a contact is too soft: its force rises by 1"));
  EXPECT_FALSE(contact.ends_run);
  EXPECT_LT(desk.peak, Body::kReflex);
}

}  // namespace
}  // namespace palpate::baxter
