// SPDX-License-Identifier: MIT
// Whether this program got to listen.
#include "baxter/ros/pulse.hpp"

#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

TEST(Pulse, IsWithoutGapsWhileItBeats) {
  Pulse pulse(100.0);
  for (int i = 1; i <= 100; ++i) pulse.beat(100.0 + 0.005 * i);
  EXPECT_EQ(pulse.longest(100.505), 0.0);
}

TEST(Pulse, KnowsTheGapThatIsGoingOnAndRemembersTheLongestOfTheLastSecond) {
  Pulse pulse(0.0);
  EXPECT_DOUBLE_EQ(pulse.longest(0.25), 0.25) << "before it has ended";
  pulse.beat(0.25);
  pulse.beat(0.30);
  EXPECT_DOUBLE_EQ(pulse.longest(0.30), 0.25);
  for (double now = 0.305; now < 1.2501; now += 0.005) pulse.beat(now);
  EXPECT_DOUBLE_EQ(pulse.longest(1.25), 0.25);
  pulse.beat(1.255);
  EXPECT_NEAR(pulse.longest(1.255), 0.05, 1e-12) << "the longer one ended more than a second ago";
}

}  // namespace
}  // namespace palpate::baxter
