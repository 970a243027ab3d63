// SPDX-License-Identifier: MIT
// Readings are counted, not looks: streams that are slow, and a driver that is.
#include "baxter/watch_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace palpate::baxter {
namespace {

using test::kInside;
using test::kSpace;
using test::pose;
using test::sound;
using testing::HasSubstr;
using Then = Fault::Then;

TEST(AForce, ThatIsLookedAtAgainIsStillOneReading) {
  Watch watch(kSpace, 14.0);
  watch.set_tare(Eigen::Vector3d(0.3, -0.2, 1.0));
  Snapshot seen = sound(1.0, pose());
  seen.endpoint->force.z() += 40.0;
  for (int i = 0; i < 6; ++i) {
    seen.now += 0.01;
    EXPECT_FALSE(watch.look(seen, kInside));
    EXPECT_EQ(watch.fresh(), i == 0);
  }
}

/// Looks every `period` seconds, for three seconds, at streams that come so often a second; what stopped that, if any.
std::optional<Fault> looked(double period, double joints, double endpoint, bool simulated = false) {
  Watch watch(kSpace, 14.0);
  for (int i = 0; i * period < 3.0; ++i) {
    const double now = 1.0 + i * period;
    Snapshot seen = sound(now, pose());
    seen.simulated = simulated;
    const auto latest = [now](Arrival& arrival, double rate) {
      arrival.received = std::floor(now * rate + 1e-6) / rate;
      arrival.stamp = arrival.received + 5.0;
    };
    latest(*seen.joints, joints);
    latest(*seen.endpoint, endpoint);
    if (const std::optional<Fault> fault = watch.look(seen, kInside)) return fault;
  }
  return std::nullopt;
}

TEST(AStream, BelowFiftyHertzStopsTheArm) {
  for (const double rate : {100.0, 70.0, 50.0}) EXPECT_FALSE(looked(0.01, rate, rate)) << rate;
  for (const double rate : {45.0, 25.0, 20.0}) {
    const std::optional<Fault> force = looked(0.01, 100.0, rate);
    ASSERT_TRUE(force) << rate;
    EXPECT_THAT(force->reason, HasSubstr("endpoint_state of the left arm came only "));
    EXPECT_THAT(force->reason, HasSubstr(" times in the last 0.5 s, 25 are needed"));
    EXPECT_EQ(force->then, Then::hold);
    const std::optional<Fault> joints = looked(0.01, rate, 100.0);
    ASSERT_TRUE(joints) << rate;
    EXPECT_THAT(joints->reason, HasSubstr("/robot/joint_states of the left arm came only "));
  }
}

TEST(ADriver, ThatGetsToTheArmTooSeldomBlamesItsComputer) {
  const std::optional<Fault> own = looked(0.03, 100.0, 100.0);
  ASSERT_TRUE(own);
  EXPECT_THAT(own->reason, HasSubstr("this computer got to the arm 17 times in the last 0.5 s, 25 are needed"));
  EXPECT_FALSE(looked(0.03, 100.0, 100.0, true)) << "a simulated clock does not wait";
  EXPECT_TRUE(looked(0.03, 100.0, 12.0, true)) << "a stream that is slower than the driver is not its fault";
}

TEST(AGap, OfTheDriversOwnIsNotBlamedOnTheNetwork) {
  Watch watch(kSpace, 14.0);
  ASSERT_FALSE(watch.look(sound(1.0, pose()), kInside));
  Snapshot seen = sound(1.0, pose());
  seen.now = 1.15;  // nobody looked, and nobody received
  const std::optional<Fault> own = watch.look(seen, kInside);
  ASSERT_TRUE(own);
  EXPECT_THAT(own->reason, testing::StartsWith("this computer did not get to the arm for 0.15 s"));

  Watch receiving(kSpace, 14.0);
  for (double now = 1.0; now < 1.1; now += 0.01) {
    Snapshot held = sound(1.0, pose());
    held.now = now;
    ASSERT_FALSE(receiving.look(held, kInside));
  }
  seen.now = 1.12;
  EXPECT_THAT(receiving.look(seen, kInside)->reason, HasSubstr("see to the network"));
  seen.own_gap = 0.12;
  EXPECT_THAT(receiving.look(seen, kInside)->reason, HasSubstr("this computer did not get to the arm for 0.12 s"));
}

}  // namespace
}  // namespace palpate::baxter
