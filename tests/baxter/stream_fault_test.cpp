// SPDX-License-Identifier: MIT
// Streams of the simulated robot that are late, in bursts or rare, and other faults of their contents.
#include "body_bench.hpp"
#include "fake_baxter/delivery.hpp"

#include <gtest/gtest.h>

namespace palpate::test {
namespace {

using fake_baxter::Body;
using fake_baxter::Delivery;
using fake_baxter::RobotMessages;

/// Returns the messages of one second by the period of their arrival.
std::vector<std::vector<RobotMessages>> second(BodyBench& bench) {
  Delivery delivery;
  std::vector<std::vector<RobotMessages>> out;
  for (int i = 0; i < 100; ++i) {
    bench.hold(Body::kPeriod);
    out.push_back(delivery.take(bench.body));
    for (const RobotMessages& said : out.back()) EXPECT_EQ(said.endpoint->received, bench.body.now());
  }
  return out;
}

std::vector<double> stamps(const std::vector<std::vector<RobotMessages>>& arrived) {
  std::vector<double> out;
  for (const auto& period : arrived) {
    for (const RobotMessages& said : period) out.push_back(said.endpoint->stamp);
  }
  return out;
}

void expect_a_hundred_a_second(const std::vector<double>& stamps) {
  for (std::size_t i = 1; i < stamps.size(); ++i) EXPECT_NEAR(stamps[i] - stamps[i - 1], 0.01, 1e-9) << i;
}

TEST(Delivery, BringsEachPeriodWhatIsSaidInIt) {
  BodyBench bench;
  for (const auto& period : second(bench)) {
    ASSERT_EQ(period.size(), 1U);
    EXPECT_EQ(period[0].endpoint->stamp, period[0].endpoint->received);
  }
}

TEST(Delivery, InBurstsBringsAllThatWasSaidSinceTheBurstBefore) {
  BodyBench bench;
  bench.inject("bursts=0.045");
  const auto arrived = second(bench);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].size(), i == 0 ? 1U : i % 5 == 0 ? 5U : 0U) << "every fifth period is the first after 45 ms";
  }
  expect_a_hundred_a_second(stamps(arrived));
}

TEST(Delivery, BehindAStallBringsAllAtOnceAndThenGoesOn) {
  BodyBench bench;
  bench.inject("stall=0.3");
  const auto arrived = second(bench);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].size(), i < 29 ? 0U : i == 29 ? 30U : 1U) << i;
  }
  expect_a_hundred_a_second(stamps(arrived));
}

TEST(FakeBody, ASlowEndpointComesAtItsRateAndTheOtherStreamsAtTheirs) {
  for (const auto& [rate, words] :
       {std::pair(25, "slow_endpoint"), {30, "slow_endpoint=30"}, {100, "slow_endpoint=100"}}) {
    BodyBench bench;
    bench.inject(words);
    int endpoints = 0;
    for (int i = 0; i < 1000; ++i) {
      bench.hold(Body::kPeriod);
      const RobotMessages said = bench.body.messages();
      endpoints += said.endpoint ? 1 : 0;
      EXPECT_TRUE(said.joints && said.state && said.collision);
    }
    EXPECT_EQ(endpoints, 10 * rate);
  }
}

TEST(FakeBody, OneReadingInAHundredHasASpikeOfNineNewtonsAsThoughItWerePressedUpwards) {
  BodyBench bench(kBare, kQuiet);
  const double rest = bench.force().z();
  bench.inject("spikes");
  int spiked = 0;
  for (int i = 0; i < 10000; ++i) {
    bench.hold(Body::kPeriod);
    const double change = bench.force().z() - rest;
    if (std::abs(change) < 1.0) continue;  // noise of 0.01 N
    EXPECT_NEAR(change, -Body::kSpike, 0.1);
    ++spiked;
  }
  EXPECT_NEAR(spiked, 100, 40) << "four standard deviations of so many drawn";
  EXPECT_EQ(bench.body.pressing(), 0.0);
}

TEST(FakeBody, InMotionItsForceIsOffAgainstTheMotionAndSidewaysAndAtRestItIsNot) {
  // The bias of the pose is equal in both, so the difference is the fault.
  BodyBench sound(kBare, kQuiet);
  BodyBench faulty(kBare, kQuiet);
  faulty.inject("moving_force=4");
  const auto off = [&](double to, bool at_rest) {
    for (BodyBench* bench : {&sound, &faulty}) {
      bench->lead({0.115, 0.115, to}, 0.03);
      if (at_rest) bench->hold(3.0);
    }
    return Eigen::Vector3d(faulty.force() - sound.force());
  };
  const Eigen::Vector3d down = off(0.10, false);
  const Eigen::Vector3d below = off(0.10, true);
  const Eigen::Vector3d up = off(0.16, false);
  EXPECT_NEAR(down.z(), -4.0, 0.1) << "as though it were pressed upwards";
  EXPECT_NEAR(up.z(), 4.0, 0.1);
  EXPECT_LT(below.norm(), 0.05);
  EXPECT_GT(down.head<2>().norm(), 1.0);
  EXPECT_LT((down + up).norm(), 0.5) << "the other way round";
}

TEST(FakeBody, SaysWhatItsCollisionAvoidanceKeepsAwayFrom) {
  const auto avoided = [](const char* fault) {
    BodyBench bench;
    if (*fault != '\0') bench.inject(fault);
    return *bench.body.messages().avoidance;
  };
  const auto nothing = avoided("");
  EXPECT_TRUE(!nothing.other_arm && nothing.objects.empty());
  const auto torso = avoided("avoid");
  EXPECT_TRUE(!torso.other_arm && torso.objects == std::vector<std::string>{"torso"});
  const auto arm = avoided("avoid=other_arm");
  EXPECT_TRUE(arm.other_arm && arm.objects.empty());
}

TEST(FakeBody, TheEffortsOfItsJointsHaveThePowerWithWhichItPresses) {
  BodyBench bench(kBare, kQuiet);
  EXPECT_EQ(bench.body.messages().effort.norm(), 0.0);
  bench.lead({0.115, 0.115, -0.005}, 0.02);
  bench.hold(3.0);
  // For a small motion, the work of the joints equals that of the contact force.
  const RobotMessages said = bench.body.messages();
  const baxter::Joints joints = bench.body.joints();
  for (int i = 0; i < 7; ++i) {
    baxter::Joints moved = joints;
    moved(i) += 1e-5;
    const double rise = bench.tool.tip(moved).position.z() - bench.tool.tip(joints).position.z();
    EXPECT_NEAR(said.effort(i), -bench.body.pressing() * rise / 1e-5, 1e-3) << i;
  }
}

TEST(FakeBody, AnotherProgramMaySlowItDownAndShortenItsPatienceInTheMiddleOfARun) {
  BodyBench bench(kBare, kQuiet);
  EXPECT_EQ(bench.body.speed_ratio(), 0.3);
  EXPECT_EQ(bench.body.command_timeout(), 0.2);
  bench.inject("speed_ratio", "1:12cm");
  bench.inject("command_timeout=0.05", "1:12cm");
  EXPECT_EQ(bench.body.speed_ratio(), 0.3);
  bench.lead({0.115, 0.115, 0.10}, 0.05);
  bench.hold(1.0);
  EXPECT_EQ(bench.body.speed_ratio(), 0.03);
  EXPECT_EQ(bench.body.command_timeout(), 0.05);
}

}  // namespace
}  // namespace palpate::test
