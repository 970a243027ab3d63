// SPDX-License-Identifier: MIT
// New readings count, not reads: slow streams, a slow driver, and a driver that could not receive.
#include "baxter/guard_bench.hpp"
#include "baxter/ros/thread_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::baxter {
namespace {

using test::IsFault;
using test::IsNothing;
using test::kInside;
using test::kZero;
using test::pose;
using test::Rules;
using test::sound;
using AllowedAction = Fault::AllowedAction;

TEST(AForce, ThatIsLookedAtAgainIsStillOneReading) {
  Rules rules;
  rules.set_tare(kZero);
  Snapshot seen = sound(1.0, pose());
  seen.endpoint->force.z() += 40.0;
  for (int i = 0; i < 6; ++i) {
    seen.now += 0.01;
    EXPECT_THAT(rules.check(seen, kInside), IsNothing());
    EXPECT_EQ(rules.fresh(), i == 0);
  }
}

/// Reads every `period` seconds for three seconds streams of these rates (Hz). Returns the first fault, if any.
std::optional<Fault> looked(double period, double joints, double endpoint, bool simulated = false) {
  Rules rules;
  for (int i = 0; i * period < 3.0; ++i) {
    const double now = 1.0 + i * period;
    const auto latest = [now](MessageArrival& arrival, double rate) {
      arrival.received = std::floor(now * rate + 1e-6) / rate;
      arrival.stamp = arrival.received + 5.0;
      arrival.count = std::lround(arrival.received * rate);
    };
    const std::optional<Fault> fault = rules.at(now, [&](Snapshot& s) {
      s.simulated = simulated;
      latest(*s.joints, joints);
      latest(*s.endpoint, endpoint);
      s.endpoint->renewals = s.endpoint->count;
    });
    if (fault) return fault;
  }
  return std::nullopt;
}

TEST(AStream, BelowFiftyHertzStopsTheArm) {
  for (const double rate : {100.0, 70.0, 50.0}) EXPECT_FALSE(looked(0.01, rate, rate)) << rate;
  for (const double rate : {45.0, 25.0, 20.0}) {
    const std::optional<Fault> force = looked(0.01, 100.0, rate);
    EXPECT_THAT(force, IsFault("endpoint_state of the left arm arrived only ", AllowedAction::hold)) << rate;
    EXPECT_THAT(force, IsFault(" times in the last 0.5 s, 25 are needed", AllowedAction::hold)) << rate;
    EXPECT_THAT(looked(0.01, rate, 100.0),
                IsFault("/robot/joint_states of the left arm arrived only ", AllowedAction::hold));
  }
}

TEST(ADriver, ThatGetsToTheArmTooSeldomBlamesItsComputer) {
  EXPECT_THAT(looked(0.03, 100.0, 100.0),
              IsFault("this computer served the arm 17 times in the last 0.5 s, 25 are needed", AllowedAction::hold));
  EXPECT_THAT(looked(0.03, 100.0, 100.0, true), IsNothing()) << "a simulated clock does not wait";
  EXPECT_TRUE(looked(0.03, 100.0, 12.0, true)) << "a stream that is slower than the driver is not its fault";
}

TEST(AGap, OfTheDriversOwnIsNotBlamedOnTheNetwork) {
  Rules rules;
  ASSERT_THAT(rules.at(1.0), IsNothing());
  Snapshot seen = sound(1.0, pose());
  seen.now = 1.15;  // without reads and reception
  EXPECT_THAT(rules.check(seen, kInside),
              IsFault("this computer could not serve the arm for 0.15 s", AllowedAction::silence));

  Rules receiving;
  for (seen.now = 1.0; seen.now < 1.1; seen.now += 0.01) ASSERT_THAT(receiving.check(seen, kInside), IsNothing());
  seen.now = 1.12;
  EXPECT_THAT(receiving.check(seen, kInside), IsFault("check the network", AllowedAction::silence));
  seen.own_gap = 0.12;
  EXPECT_THAT(receiving.check(seen, kInside),
              IsFault("this computer could not serve the arm for 0.12 s", AllowedAction::silence));
}

TEST(Heartbeat, IsWithoutGapsWhileItBeats) {
  Heartbeat heartbeat(100.0);
  for (int i = 1; i <= 100; ++i) heartbeat.beat(100.0 + 0.005 * i);
  EXPECT_EQ(heartbeat.longest(100.505), 0.0);
}

TEST(Heartbeat, KnowsTheGapThatIsGoingOnAndRemembersTheLongestOfTheLastSecond) {
  Heartbeat heartbeat(0.0);
  EXPECT_DOUBLE_EQ(heartbeat.longest(0.25), 0.25) << "before it has ended";
  heartbeat.beat(0.25);
  heartbeat.beat(0.30);
  EXPECT_DOUBLE_EQ(heartbeat.longest(0.30), 0.25);
  for (double now = 0.305; now < 1.2501; now += 0.005) heartbeat.beat(now);
  EXPECT_DOUBLE_EQ(heartbeat.longest(1.25), 0.25);
  heartbeat.beat(1.255);
  EXPECT_NEAR(heartbeat.longest(1.255), 0.05, 1e-12) << "the longer one ended more than a second ago";
}

}  // namespace
}  // namespace palpate::baxter
