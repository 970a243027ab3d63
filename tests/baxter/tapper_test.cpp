// SPDX-License-Identifier: MIT
// Consecutive taps on a robot in this process: measured heights, path of the arm, contact forces.
#include "baxter/tapper_bench.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using fake_baxter::Body;
using test::calibrate;
using test::fake_options;
using test::kHover;
using test::kOnDesk;
using test::kOnObject;
using test::wave_scene;
using test::with;
using Bench = test::TapperBench;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using Type = tapping::MotionOptions::Type;

/// Puts the tip of the robot at this position at the start.
test::Change<test::BodyOptions> starts(const Eigen::Vector3d& at) {
  return [at](test::BodyOptions& body) { body.start_at = at; };
}

TEST(ATap, FindsTheObjectAndTheDeskAndEndsAtTheHeightOfTravel) {
  Bench bench;
  bench.check();
  const std::vector<Target> places{kOnObject, kOnDesk, {0.115, 0.05}, {0.2, 0.21}};
  constexpr int kTaps = 12;
  for (int tap = 0; tap < kTaps; ++tap) {
    const tapping::HeightResult contact = bench.touch(places[static_cast<std::size_t>(tap) % places.size()]);
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
    EXPECT_GT(contact.force, 5.0);
    EXPECT_LT(contact.force, Body::kReflex);
    EXPECT_GE(contact.peak_force.value(), 5.0);
    EXPECT_LT(contact.peak_force.value(), Body::kReflex);
    EXPECT_GT(contact.seconds, 2.0);
    // The first taps are slow, because a soft object shows little about the delay of a detection.
    EXPECT_LT(contact.seconds, tap < 4 ? 32.0 : 24.0) << tap;
    EXPECT_EQ(contact.reason, "");
  }
}

TEST(ATap, IsMadeByTheMotionThatIsAskedFor) {
  Bench bench(with([&](BaxterOptions& o) {
    const tapping::MotionOptions alone = o.motion;
    o.motion.type = Type::per_tap;
    o.motion.of = {alone, alone};
    for (tapping::MotionOptions& one : o.motion.of) one.type = Type::continuous;
    o.motion.of[0].speed = 0.005;
    o.motion.of[1].speed = 0.01;
  }));
  bench.check();
  const auto seconds = [&](int motion) {
    // The first tap starts elsewhere. The others start above their position and improve the known delay of a detection.
    for (int i = 0; i < 5; ++i) bench.tap(kOnDesk, motion);
    const tapping::HeightResult contact = bench.tap(kOnDesk, motion);
    EXPECT_EQ(contact.outcome, Outcome::contact);
    return contact.seconds;
  };
  // Parts at 0.5 cm/s and at 1 cm/s: 13.5 cm down, one centimetre before each of two rests, and the start of the rise.
  EXPECT_NEAR(seconds(0) - seconds(1), 15.5 / 0.5 - 15.5 / 1.0, 1.5);
}

TEST(ATap, CanBeMadeInEveryMotion) {
  for (const Type type : {Type::paper, Type::two_stage, Type::continuous}) {
    Bench bench(with([&](BaxterOptions& o) { o.motion.type = type; }));
    double hardest = 0.0;
    bench.robot.every_period = [&] { hardest = std::max(hardest, bench.robot.body.pressing()); };
    // The object yields by the force divided by 1500 N/m.
    for (const Target& place : {kOnObject, kOnDesk}) bench.touch(place, type == Type::continuous ? 0.002 : 0.01);
    EXPECT_LT(hardest, Body::kReflex) << "the firmware never had to stop it";
  }
}

TEST(ATap, CommandsTheMeasuredJointsFirstAndNeverJumpsButBackToThem) {
  Bench bench;
  const Joints before = bench.robot.body.joints();
  std::vector<Joints> measured;
  bench.robot.every_period = [&] { measured.push_back(bench.robot.body.joints()); };
  bench.tap(kOnObject);
  bench.tap(kOnDesk);
  ASSERT_GT(bench.robot.commands.size(), 400U);
  EXPECT_EQ(bench.robot.commands.front(), before);
  ASSERT_EQ(measured.size(), bench.robot.commands.size()) << "one set-point a period";
  for (std::size_t i = 1; i < measured.size(); ++i) {
    const Joints& now = bench.robot.commands[i];
    const double step = (now - bench.robot.commands[i - 1]).cwiseAbs().maxCoeff();
    EXPECT_TRUE(step < 0.01 || now == measured[i - 1]) << "period " << i << ": " << step;
  }
}

TEST(ATap, BelowTheHeightOfTravelGoesStraightUpFirst) {
  Bench bench(fake_options(), starts({0.02, 0.02, -0.002}));
  const Eigen::Vector3d start = bench.robot.body.tip();
  double aside = 0.0;
  bool up = false;
  bench.robot.every_period = [&] {
    const Eigen::Vector3d tip = bench.robot.body.tip();
    up = up || tip.z() > kHover - 0.02;
    if (!up) aside = std::max(aside, (tip - start).head<2>().norm());
  };
  EXPECT_EQ(bench.tap(kOnObject).outcome, Outcome::contact);
  EXPECT_TRUE(up);
  EXPECT_LT(aside, 0.002);
}

TEST(ATap, GoesOnAfterTheArmWasMovedByHandInBetween) {
  Bench bench;
  bench.touch(kOnDesk);
  bench.lead_away(test::PlannerBench().at(0.2, 0.05, 0.2));
  bench.touch(kOnObject);
}

TEST(ATap, IsDescribedFromWhereTheArmIsAndNothingMoves) {
  Bench bench(with([](BaxterOptions& o) { calibrate(o, 0.02, 0.02); }), starts({0.04, 0.07, 0.05}));
  EXPECT_THAT(
      bench.describe({0.1, 0.2}),
      ElementsAre(
          "rise from 5.0 cm above the desk", "before it, a calibration tap on the bare desk at (2.0, 2.0) cm",
          "travel from (4.0, 7.0) cm to (10.0, 20.0) cm at 13.5 cm above the desk, 15.0 cm/s",
          "descend at 0.4 cm/s to at most 2.0 cm below the desk", "stop at 5.0 N above the tare: a contact",
          "press with at most about 13.5 N on something rigid: the arm's springs have 4.5 kN/m there, and 535 ms "
          "pass from 5.0 N to standstill, so that motion.speed is not reached",
          "stop the descent when the force changes by 14.0 N upwards or downwards, and by half as much again "
          "sideways"));
  EXPECT_TRUE(bench.robot.commands.empty());
  ASSERT_EQ(bench.tap(kOnObject).outcome, Outcome::contact);
  EXPECT_THAT(bench.describe(kOnDesk)[0], StartsWith("travel from (11.")) << "calibrated, and at the height of travel";
}

TEST(ATap, OutOfReachMovesNothing) {
  Bench bench(with([](BaxterOptions& o) { o.scene_pose.corner[0] = 0.9; }));
  const tapping::HeightResult contact = bench.tap({0.23, 0.0});
  EXPECT_EQ(contact.outcome, Outcome::unreachable);
  EXPECT_THAT(contact.reason, StartsWith("no joint position"));
  EXPECT_FALSE(contact.ends_run);
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(ATap, ThatMeetsNothingEndsAboveTheFloor) {
  Bench bench(with([](BaxterOptions& o) { o.scene_pose.height += 0.1; }));  // the desk is lower than in the config
  const tapping::HeightResult contact = bench.tap(kOnDesk);
  EXPECT_EQ(contact.outcome, Outcome::no_contact);
  EXPECT_FALSE(contact.ends_run);
  EXPECT_GT(*std::min_element(bench.robot.heights.begin(), bench.robot.heights.end()), 0.1 - 0.03);
}

TEST(ACalibrationTap, PutsTheZeroWhereTheDeskIs) {
  Bench bench(with([](BaxterOptions& o) {
    o.scene_pose.height += 0.006;  // measured too high
    calibrate(o, 0.02, 0.02);
  }));
  bench.touch(kOnObject);
  bench.touch(kOnDesk);  // one calibration is sufficient
}

TEST(ACalibrationTap, EndsTheRunWhereTheDeskIsNotNearWhereTheConfigHasIt) {
  Bench bench(with([](BaxterOptions& o) { calibrate(o, 0.115, 0.115); }));  // on the object
  const tapping::HeightResult contact = bench.tap(kOnDesk);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_THAT(contact.reason, HasSubstr("cm higher than scene_pose.height"));
}

TEST(ATap, OfARobotWhoseForceRisesIsTheSameOnceTheConfigSaysSo) {
  for (const Type type : {Type::paper, Type::two_stage, Type::continuous}) {
    const auto tapped = [&](bool rises) {
      Bench bench(with([&](BaxterOptions& o) {
        o.motion.type = type;
        if (rises) o.force_sign = BaxterOptions::ForceSign::positive;
      }));
      if (rises) bench.robot.spoil = [](Snapshot& seen) { seen.endpoint->force.z() *= -1.0; };
      return bench.tap(kOnObject);
    };
    const tapping::HeightResult falls = tapped(false);
    const tapping::HeightResult rises = tapped(true);
    ASSERT_EQ(rises.outcome, Outcome::contact) << rises.reason;
    // The first reading preceded the change of the sign.
    EXPECT_NEAR(rises.height, falls.height, 0.003);
    EXPECT_NEAR(rises.force, falls.force, 3.0);
  }
}

TEST(ACalibrationTap, LearnsTheSignOfTheForceAndComesDownGently) {
  for (const double sign : {1.0, -1.0}) {
    Bench bench(with([](BaxterOptions& o) { calibrate(o, 0.02, 0.02); }));  // without force_sign in the options
    bench.robot.spoil = [&](Snapshot& seen) { seen.endpoint->force.z() *= sign; };
    double hardest = 0.0;
    bench.robot.every_period = [&] {
      if (bench.robot.body.tip().x() < 0.04) hardest = std::max(hardest, bench.robot.body.pressing());
    };
    for (const Target& place : {kOnObject, Target{0.2, 0.2}}) bench.touch(place, 0.003);
    EXPECT_EQ(bench.learnt_sign(), sign > 0.0 ? "negative" : "positive");
    EXPECT_LT(hardest, 11.0) << "4 N, and the noise and the lag of an arm that stops";
    EXPECT_GT(hardest, 2.0);
  }
}

TEST(ForceSign, IsLearntWithACalibrationTapAndElseThatOfOtherProgramsUnlessTheConfigSaysIt) {
  using Sign = BaxterOptions::ForceSign;
  BaxterOptions options;
  EXPECT_EQ(options.sign(), Sign::negative);
  options.calibration.emplace();
  EXPECT_EQ(options.sign(), Sign::learn);
  options.force_sign = Sign::positive;
  EXPECT_EQ(options.sign(), Sign::positive);
}

TEST(ATap, InTwoStagesTaresTheStopAgainWithTheSecondStage) {
  Bench bench(with([](BaxterOptions& o) { o.motion.type = Type::two_stage; }));
  // After the first contact the springs have another zero. Together with the second contact's force it would be too
  // much.
  bool touched = false;
  bool over = false;
  bench.robot.spoil = [&](Snapshot& seen) {
    const double height = bench.robot.body.tip().z();
    touched = touched || height < -0.003;
    over = over || (touched && height > 0.005);
    const double trembles = 0.1 * std::sin(1000.0 * seen.now);  // a real sensor never repeats a value exactly
    seen.endpoint->force = {over && height < 0.05 ? 13.0 : 0.0, 0.0, trembles - bench.robot.body.pressing()};
  };
  const tapping::HeightResult contact = bench.tap(kOnDesk);
  EXPECT_EQ(contact.outcome, Outcome::contact) << contact.reason;
}

/// Adds `offset` newtons to the force at 2 cm/s downwards, the negative upwards, at most twice that.
std::function<void(Snapshot&)> moves(double offset, const Bench& bench) {
  return [=, &bench, last = 0.0, at = 0.0, speed = 0.0](Snapshot& seen) mutable {
    const double height = bench.tip();
    if (seen.now > at) speed = (height - last) / (seen.now - at);
    last = height;
    at = seen.now;
    seen.endpoint->force.z() -= offset * std::clamp(speed / 0.02, -2.0, 2.0);
  };
}

TEST(ATap, IsBelievedThoughTheForceIsAnotherWhileTheArmMoves) {
  for (const double offset : {4.0, -4.0}) {
    Bench bench;
    bench.robot.spoil = moves(offset, bench);
    for (const Target& place : {kOnObject, kOnDesk, Target{0.2, 0.03}, Target{0.115, 0.08}}) bench.touch(place, 0.003);
    EXPECT_THAT(bench.notes, testing::Contains(StartsWith("during the descent in air the force along z differs by ")));
  }
}

TEST(ATap, EndsWithAWayUpNoFasterThanAForceThatDependsOnTheSpeedAllows) {
  for (const double offset : {0.0, 4.0}) {
    Bench bench;
    if (offset > 0.0) bench.robot.spoil = moves(offset, bench);
    double last = 0.0;
    double fastest = 0.0;  // m/s upwards, away from the desk and from the rest
    bench.robot.every_period = [&] {
      const double height = bench.tip();
      if (height > 0.03 && height < 0.1) fastest = std::max(fastest, (height - last) / 0.01);
      last = height;
    };
    for (int tap = 0; tap < 3; ++tap) bench.touch(kOnDesk, 0.003);
    EXPECT_LT(fastest, offset > 0.0 ? 0.06 : 0.11) << offset;
    EXPECT_GT(fastest, offset > 0.0 ? 0.01 : 0.08) << offset;
  }
}

/// Makes one reading of the force in a hundred 9 N wrong; then no new one arrives for `stalled` periods.
std::function<void(Snapshot&)> spikes(int stalled, const Bench& bench) {
  return [=, &bench, held = std::optional<EndpointReading>(), left = 0,
          random = Random(5, "spikes")](Snapshot& seen) mutable {
    if (left > 0 && --left > 0) {
      seen.endpoint = held;
      return;
    }
    if (bench.tip() > kHover - 0.005 || random.uniform() > 0.01) return;
    seen.endpoint->force.z() -= 9.0;
    held = seen.endpoint;
    left = stalled;
  };
}

TEST(ATap, IsNotFooledByOneLoudReadingThatStaysTheLatest) {
  Bench bench;
  bench.robot.spoil = spikes(5, bench);
  for (int i = 0; i < 40; ++i) {
    const Target place{0.02 + 0.01 * (i % 20), i % 2 == 0 ? 0.02 : 0.115};
    const tapping::HeightResult contact = bench.tap(place);
    if (contact.outcome != Outcome::contact) continue;  // a rejected contact is not wrong
    ASSERT_NEAR(contact.height, wave_scene().height(place.x, place.y), 0.004) << "tap " << i;
  }
}

TEST(ATap, DoesNotMakeUpForPeriodsThatItsComputerMissed) {
  Bench bench;
  int period = 0;
  bench.robot.late = [&] { return ++period % 20 == 0 ? 0.045 : 0.0; };
  bench.touch(kOnObject, 0.003);
  ASSERT_GT(bench.robot.commanded.size(), 300U);
  for (std::size_t i = 1; i < bench.robot.commanded.size(); ++i) {
    ASSERT_GT(bench.robot.commanded[i] - bench.robot.commanded[i - 1], 0.0099) << "set-point " << i;
  }
}

TEST(ATap, IsNotBegunWhereTheWayToItCannotBePlanned) {
  Bench bench(test::asking(), starts({0.02, 0.02, 0.05}));
  const test::PlannerBench plans;
  const ArmKinematics gripper({0, 0, 0.025});
  bench.robot.answer = [&](const Pose& pose, const Joints& seed) {
    const Eigen::Vector3d at = plans.planner.to_scene(pose.position);
    const bool on_the_way = (at - Eigen::Vector3d(0.07, 0.07, at.z())).norm() < 0.02;
    return on_the_way ? std::nullopt : gripper.solve(pose, seed);
  };
  EXPECT_EQ(bench.tap(kOnObject).outcome, Outcome::unreachable);
  EXPECT_TRUE(bench.robot.commands.empty()) << "it would have gone up first";
}

}  // namespace
}  // namespace palpate::baxter
