// SPDX-License-Identifier: MIT
#include "elastic_arm.hpp"
#include "support/filled.hpp"
#include "support/testing.hpp"

namespace palpate::tapping {
namespace {

using test::ElasticArm;

MotionOptions motion(const std::string& type) {
  return test::filled<MotionOptions>("{type: " + type + ", speed: 1.5 cm/s, threshold: 5 N, tare: 500 ms}");
}

TEST(RealArmTap, FindsSomethingSoftWithinTenSecondsOfTheFirstTouch) {
  for (const char* type : {"continuous", "paper"}) {
    for (const double object : {1000.0, 2000.0, 5000.0}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        ElasticArm arm;
        arm.surface = 0.05;
        arm.object = object;
        arm.seed = seed;
        const GuardedTap tap = arm.tap(motion(type));
        const auto touches = [](const ElasticArm::Period& one) { return one.force > 0.0; };
        const auto first = std::find_if(arm.periods.begin(), arm.periods.end(), touches);
        ASSERT_EQ(tap.result().outcome, Outcome::contact)
            << type << " at " << object << " N/m: " << tap.result().reason << " after " << tap.seconds() << " s";
        EXPECT_LT(static_cast<double>(arm.periods.end() - first) * GuardedTap::kPeriod, 10.0);
        EXPECT_LT(arm.peak(), 10.0) << type << " at " << object << " N/m";
      }
    }
  }
}

TEST(RealArmTap, FindsNoContactInAZeroThatChangesWithThePose) {
  for (const double drift : {-50.0, -35.0, 35.0, 50.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      ElasticArm arm;
      arm.surface = -1.0;
      arm.noise = 1.5;
      arm.seed = seed;
      arm.zero = [=](double height) { return drift * (0.135 - height); };
      const GuardedTap tap = arm.tap(motion("continuous"));
      EXPECT_EQ(tap.result().outcome, Outcome::no_contact)
          << drift << " N/m: a contact at " << tap.result().height << " m";
    }
  }
}

TEST(RealArmTap, FindsTheHeightThoughTheZeroChangesWithThePose) {
  for (const double drift : {-50.0, 0.0, 50.0}) {
    for (const double object : {3000.0, 50000.0}) {
      ElasticArm arm;
      arm.surface = 0.02;
      arm.object = object;
      arm.noise = 1.0;
      arm.zero = [=](double height) { return drift * (0.135 - height); };
      const GuardedTap tap = arm.tap(motion("continuous"));
      ASSERT_EQ(tap.result().outcome, Outcome::contact) << drift << " N/m";
      EXPECT_NEAR(tap.result().height, arm.surface, 0.001) << drift << " N/m, " << object << " N/m";
    }
  }
}

TEST(RealArmTap, NoticesVerySoftThingsBeforeTheFirmwareDoes) {
  for (const double object : {200.0, 300.0, 400.0, 600.0}) {
    ElasticArm arm;
    arm.surface = 0.11;
    arm.object = object;
    const GuardedTap tap = arm.tap(motion("continuous"));
    EXPECT_LT(arm.peak(), 16.0) << object << " N/m";
    if (object < 400.0) continue;  // rises too slowly for a contact
    EXPECT_EQ(tap.result().outcome, Outcome::contact) << object << " N/m";
  }
}

TEST(FreeForce, IsALineThroughTheLastCentimetresOfFreeTravel) {
  FreeForce free(0.008, 0.13);
  free.tare(2.0);
  EXPECT_EQ(free.line(0.1).at(0.1), 2.0) << "nothing but the tare is known";
  for (int i = 0; i < 1000; ++i) {
    const double height = 0.13 - 1e-4 * i;
    free.add({height, 2.0 + 40.0 * (0.13 - height)});
  }
  EXPECT_NEAR(free.line(0.05).at(0.05), 2.0 + 40.0 * 0.08, 0.15);
  EXPECT_NEAR(free.line(0.05).slope, -40.0, 2.0);
}

TEST(FreeForce, LeavesOutWhatMayBeAContact) {
  FreeForce free(0.008, 0.1);
  for (int i = 0; i < 1000; ++i) {
    const double height = 0.1 - 1e-4 * i;
    free.add({height, height < 0.05 ? 600.0 * (0.05 - height) : 0.0});
  }
  EXPECT_NEAR(free.line(0.042).at(0.042), 0.0, 1e-9);
}

}  // namespace
}  // namespace palpate::tapping
