// SPDX-License-Identifier: MIT
// Taps after which a spring holds the tool at the contact, like a handle, tape or a magnet.
#include "baxter/spring_desk.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using fake_baxter::Body;
using fake_baxter::FaultKind;
using fake_baxter::MechanicsOptions;
using test::fake_options;
using test::kHover;
using test::kOnDesk;
using test::SpringDesk;
using testing::HasSubstr;
using testing::StartsWith;
using MotionType = tapping::MotionOptions::Type;

constexpr double kHard = 20000.0;  // N/m, desk

TEST(ACaughtTool, IsHeldWhereItIsAndToldAndNotPulledAgainstTheReflex) {
  for (const double friction : {0.0, 0.2, 0.4}) {       // Nm
    for (const double stiffness : {3000.0, 20000.0}) {  // N/m
      SpringDesk bench(kHard, fake_options(), friction);
      ASSERT_EQ(bench.tap({0.06, 0.03}).outcome,
                Outcome::contact);  // from which the driver learns the robot's properties
      bench.robot.body.inject({FaultKind::caught, stiffness, {}});
      const double begin = bench.robot.body.now();
      const tapping::HeightResult contact = bench.tap(kOnDesk);
      const std::string where = fmt::format("{} Nm, {} N/m", friction, stiffness);
      EXPECT_EQ(contact.outcome, Outcome::aborted) << where;
      EXPECT_TRUE(contact.ends_run);
      EXPECT_THAT(contact.reason, StartsWith("the tool is caught: it is pulled with ")) << where;
      EXPECT_THAT(contact.reason, HasSubstr("free it by hand before the arm moves up again; the arm holds "));
      EXPECT_EQ(bench.reflexes, 0) << where;
      EXPECT_LT(bench.pull, Body::kReflex) << where;
      EXPECT_LT(bench.robot.body.now() - begin, 30.0) << "s, most of them on the way down";
      const std::size_t sent = bench.robot.commands.size();
      bench.wait(3.0);
      EXPECT_EQ(bench.robot.commands.size(), sent);
      EXPECT_LT(std::abs(bench.robot.body.pressing()), Body::kReflex) << where;
    }
  }
}

TEST(ACaughtTool, IsNoticedInAFirstTapBeforeTheReflexWithAnyMotionAndSign) {
  BaxterOptions options = fake_options();
  for (const auto type : {MotionType::paper, MotionType::two_stage, MotionType::continuous}) {
    for (const auto sign : {BaxterOptions::ForceSign::negative, BaxterOptions::ForceSign::learn}) {
      for (const double friction : {0.0, 0.2}) {  // Nm
        options.motion.type = type;
        options.force_sign = sign;
        SpringDesk bench(kHard, options, friction);
        bench.robot.body.inject({FaultKind::caught, 3000.0, {}});
        EXPECT_THAT(bench.tap(kOnDesk).reason, StartsWith("the tool is caught: it is pulled with "));
        EXPECT_EQ(bench.reflexes, 0) << static_cast<int>(type) << ", " << friction << " Nm";
        EXPECT_LT(bench.pull, Body::kReflex);
      }
    }
  }
}

TEST(ACaughtTool, IsFreedByAPersonAndTheNextTapGoesOn) {
  SpringDesk bench(kHard, fake_options(), 0.0);
  bench.robot.body.inject({FaultKind::caught, 3000.0, {}});
  ASSERT_THAT(bench.tap(kOnDesk).reason, StartsWith("the tool is caught"));
  const tapping::HeightResult again = bench.tap(kOnDesk);
  EXPECT_TRUE(again.ends_run) << "nobody has freed it: the next run does not pull on either";
  EXPECT_THAT(again.reason, HasSubstr("the arm holds "));
  EXPECT_LE(bench.reflexes, 2);
  bench.robot.body.release();
  bench.wait(3.0);
  EXPECT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
}

TEST(ACaughtTool, IsNoticedBeforeTheReflexHoweverSoftlyItIsHeld) {
  for (const double friction : {0.0, 0.4}) {                                      // Nm
    for (const double stiffness : {150.0, 200.0, 300.0, 450.0, 600.0, 1000.0}) {  // N/m
      SpringDesk bench(kHard, fake_options(), friction);
      const std::string where = fmt::format("{} Nm, {} N/m", friction, stiffness);
      ASSERT_EQ(bench.tap({0.06, 0.03}).outcome, Outcome::contact) << where;
      bench.robot.body.inject({FaultKind::caught, stiffness, {}});
      const tapping::HeightResult contact = bench.tap(kOnDesk);
      EXPECT_THAT(contact.reason, StartsWith("the tool is caught")) << where;
      EXPECT_THAT(contact.reason, HasSubstr("; the arm holds ")) << where;
      bench.wait(10.0);
      EXPECT_EQ(bench.reflexes, 0) << where;
      EXPECT_LT(bench.pull, Body::kReflex) << where;
    }
  }
}

TEST(AnArmThatIsFree, IsNotHeldByTheFrictionOfItsJoints) {
  for (const Target& place :
       {Target{0.02, 0.21}, Target{0.21, 0.02}}) {  // positions with the most and the least friction
    SpringDesk bench(kHard, fake_options(), 0.4);
    for (int tap = 0; tap < 2; ++tap) {
      const tapping::HeightResult contact = bench.tap(place);
      EXPECT_EQ(contact.outcome, Outcome::contact) << contact.reason;
    }
  }
}

}  // namespace
}  // namespace palpate::baxter
