// SPDX-License-Identifier: MIT
#include "baxter/reaction_time.hpp"

#include "simulator/arm.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::baxter {
namespace {

constexpr double kPeriod = 0.01;

/// Returns a motion of an axis along a ramp of `way` metres at `speed`, from rest to rest, with a lag and a delay in
/// each direction. At rest its error is `begin`, then `end`.
std::vector<ReactionTime::MotionSample> motion(double lag, double delay, double way, double speed, double begin,
                                               double end) {
  backends::SimulatedAxis axis(JointLag{lag, 0.0}, kPeriod, 0.0);
  std::vector<ReactionTime::MotionSample> out;
  const auto commanded = [&](double time) { return std::clamp(speed * time, 0.0, way); };
  for (double time = 0.0; time < way / speed + 3.0; time += kPeriod) {
    axis.follow(commanded(time - 2.0 * delay));
    const double sag = begin + (end - begin) * commanded(time) / way;
    out.push_back({time, {commanded(time), 0.2, 0.1}, {axis.position() + sag, 0.2, 0.1}});
  }
  return out;
}

TEST(ReactionTime, MeasuresTheMeanDelayOfAMotionWhateverItsProfile) {
  for (const double lag : {0.05, 0.35, 0.7}) {
    for (const double delay : {0.0, 0.02, 0.07}) {
      for (const double way : {0.06, 0.2}) {
        ReactionTime reaction;
        reaction.learn_trailing(motion(lag, delay, way, 0.15, 0.002, -0.001));
        EXPECT_NEAR(reaction.trailing(), lag + 2.0 * delay, 0.012) << lag << ", " << delay << ", " << way;
      }
    }
  }
}

TEST(ReactionTime, LearnsNothingFromAShortWay) {
  ReactionTime reaction;
  reaction.learn_trailing(motion(0.35, 0.0, 0.05, 0.15, 0.0, 0.0));
  EXPECT_EQ(reaction.trailing(), ReactionTime::kFirstTrailing);
}

constexpr double kRigid = 1e9;  // N/m

/// Returns a descent at `speed` onto an object of stiffness `object` at height 0, with springs of `stiffness`. The
/// detection is `late` seconds after the force has reached `threshold`.
std::vector<ReactionTime::Period> contact(double speed, double stiffness, double threshold, double late,
                                          double object = kRigid) {
  std::vector<ReactionTime::Period> out;
  const double both = stiffness * object / (stiffness + object);
  const double noticed = threshold / (both * speed) + late;  // s after the first touch
  for (double time = -3.0; time <= noticed + 1e-9; time += kPeriod) {
    out.push_back({time, -speed * time * (time < 0.0 ? 1.0 : stiffness / (stiffness + object))});
  }
  return out;
}

TEST(ReactionTime, MeasuresByPositionsHowLateAContactIsNoticed) {
  for (const double speed : {0.004, 0.015}) {
    for (const double late : {0.05, 0.1, 0.25}) {
      ReactionTime reaction;
      for (int i = 0; i < 10; ++i) reaction.learn_noticing(contact(speed, 4000.0, 5.0, late), 0.0, 5.0, 4000.0);
      // Initial assumption: 0.04 s with a standard deviation of 0.095 s.
      const double of_one = 1.0 / std::pow(0.7 / (4000.0 * speed), 2);
      const double first = 1.0 / std::pow(0.095, 2);
      const double weights = 10.0 * of_one + first;
      const double mean = (10.0 * of_one * late + first * 0.04) / weights;
      EXPECT_NEAR(reaction.noticing(), mean + 2.0 / std::sqrt(weights) + kPeriod, 0.011) << speed << ", " << late;
    }
  }
}

TEST(ReactionTime, IsNoShorterThanTheTruthWhateverNoiseMakesOfSoftAndHardContacts) {
  constexpr double kLate = 0.15;
  Random random(1, "speeds");
  backends::GaussianNumbers normal(Random(1, "noise"));
  for (const double noise : {0.5, 0.7, 0.9}) {  // N at the detection
    for (const double object : {500.0, 1500.0, kRigid}) {
      int shorter = 0;
      int longer = 0;
      constexpr int kRuns = 300;
      for (int run = 0; run < kRuns; ++run) {
        ReactionTime reaction;
        for (int i = 0; i < 1 + run % 8; ++i) {
          const double speed = 0.005 + 0.01 * random.uniform();
          const double rise = speed * 4000.0 * object / (4000.0 + object);
          const double late = std::max(-5.0 / rise + kPeriod, kLate + noise * normal() / rise);
          reaction.learn_noticing(contact(speed, 4000.0, 5.0, late, object), 0.0, 5.0, 4000.0);
        }
        shorter += reaction.noticing() < kLate ? 1 : 0;
        longer += reaction.noticing() > 3.0 * kLate ? 1 : 0;
      }
      EXPECT_LE(shorter, kRuns / 12) << noise << " N, " << object;
      EXPECT_LE(longer, kRuns / 12) << noise << " N, " << object;
    }
  }
}

TEST(ReactionTime, LearnsLittleFromAContactWhoseForceRisesSlowly) {
  ReactionTime soft;
  ReactionTime hard;
  soft.learn_noticing(contact(0.01, 4000.0, 5.0, 0.0, 400.0), 0.0, 5.0, 4000.0);
  hard.learn_noticing(contact(0.01, 4000.0, 5.0, 0.05), 0.0, 5.0, 4000.0);
  EXPECT_GT(soft.noticing(), 0.15) << "noise of 0.7 N is 0.19 s there";
  EXPECT_FALSE(soft.measured());
  EXPECT_EQ(soft.slowest(), ReactionTime::kSlowestFirst);
  EXPECT_LT(hard.noticing(), 0.11);
  EXPECT_TRUE(hard.measured());
  const double before = hard.noticing();
  hard.learn_noticing(contact(0.01, 4000.0, 5.0, 0.4, 400.0), 0.0, 5.0, 4000.0);
  EXPECT_NEAR(hard.noticing(), before, 0.02);
  hard.learn_noticing(contact(0.01, 4000.0, 5.0, 0.4), 0.0, 5.0, 4000.0);
  EXPECT_GT(hard.noticing(), before + 0.2);
}

TEST(ReactionTime, IsFiniteAlsoWhereTheProgramWasLateAtTheNotice) {
  ReactionTime reaction;
  std::vector<ReactionTime::Period> periods = contact(0.015, 4000.0, 5.0, 0.1);
  periods.erase(periods.end() - 12, periods.end() - 1);
  reaction.learn_noticing(periods, std::nullopt, 5.0, 4000.0);
  EXPECT_GT(reaction.noticing(), 0.1);
  EXPECT_LT(reaction.noticing(), 0.4);
}

TEST(ReactionTime, FollowsARobotThatNoticesLaterAtOnceAndOneThatNoticesEarlierWithinTenContacts) {
  ReactionTime reaction;
  EXPECT_EQ(reaction.noticing(), ReactionTime::kFirstNoticing) << "nothing was measured";
  const auto learn = [&](double late) { reaction.learn_noticing(contact(0.015, 4000.0, 5.0, late), 0.0, 5.0, 4000.0); };
  for (int i = 0; i < 10; ++i) learn(0.05);
  EXPECT_NEAR(reaction.noticing(), 0.07, 0.015);
  learn(0.3);
  EXPECT_GT(reaction.noticing(), 0.27);
  for (int i = 0; i < 10; ++i) learn(0.05);
  EXPECT_NEAR(reaction.noticing(), 0.07, 0.015);
}

TEST(ReactionTime, ExpectsNoNoticeWithinFewerThanFourRenewalsOfTheForce) {
  ReactionTime reaction;
  reaction.renewed_every(0.01);
  EXPECT_EQ(reaction.noticing(), ReactionTime::kFirstNoticing);
  reaction.renewed_every(0.1);
  EXPECT_NEAR(reaction.noticing(), ReactionTime::kFirstNoticing + 0.36, 1e-12) << "nothing was measured";
  reaction.learn_noticing(contact(0.015, 4000.0, 5.0, 0.1), 0.0, 5.0, 4000.0);
  EXPECT_NEAR(reaction.noticing(), 0.4 + kPeriod, 1e-12) << "whatever was measured";
  for (int i = 0; i < 10; ++i) reaction.learn_noticing(contact(0.015, 4000.0, 5.0, 0.7), 0.0, 5.0, 4000.0);
  EXPECT_GT(reaction.noticing(), 0.7);
  EXPECT_LT(reaction.noticing(), 0.75);
}

TEST(ReactionTime, BoundsTheSpeedByTheForceThatIsExpected) {
  ReactionTime reaction;
  for (const double stiffness : {2200.0, 6400.0}) {
    const double speed = reaction.greatest_speed(5.0, stiffness);
    EXPECT_NEAR(reaction.expected_force(5.0, speed, stiffness), ReactionTime::kGreatestForce, 1e-9);
  }
  EXPECT_GT(reaction.greatest_speed(5.0, 2200.0), reaction.greatest_speed(5.0, 6400.0));
  EXPECT_GT(reaction.greatest_speed(4.0, 6400.0), reaction.greatest_speed(5.0, 6400.0));
}

TEST(ReactionTime, CountsLatenessUntilItHasFaded) {
  ReactionTime reaction;
  const double before = reaction.seconds();
  reaction.late(0.04, 10.0);
  EXPECT_NEAR(reaction.seconds(), before + 0.04, 1e-12);
  reaction.late(0.0, 20.0);
  EXPECT_GT(reaction.lateness(), 0.02);
  reaction.late(0.0, 200.0);
  EXPECT_LT(reaction.lateness(), 0.001);
}

TEST(ReactionTime, ForgetsALatenessWhileNobodyLooks) {
  ReactionTime reaction;
  reaction.late(0.04, 10.0);
  reaction.late(0.0, 10.01);
  reaction.late(0.0, 100.0);
  EXPECT_NEAR(reaction.lateness(), 0.04 * std::exp(-3.0), 1e-4) << "three times 30 s later";
}

}  // namespace
}  // namespace palpate::baxter
