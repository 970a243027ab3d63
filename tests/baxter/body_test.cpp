// SPDX-License-Identifier: MIT
// Tests of the simulated robot, against closed forms and against published properties of a real Baxter.
#include "body_bench.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::test {
namespace {

using fake_baxter::Body;
using fake_baxter::parse_fault;
using fake_baxter::parse_trigger;
using fake_baxter::RobotMessages;
using State = baxter::StateReading;

TEST(FakeBody, StandsStraightDownAboveTheMiddle) {
  const BodyBench bench;
  EXPECT_LT((bench.body.tip() - Eigen::Vector3d(0.115, 0.115, 0.165)).norm(), 2e-6);
  const Eigen::Vector3d along = bench.tool.tip(bench.body.joints()).rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT((along + Eigen::Vector3d::UnitZ()).norm(), 1e-4);
  EXPECT_LT(baxter::beyond_limits(bench.body.joints(), 0.1), 0);
}

TEST(FakeBody, TrailsItsSetPointInEveryJointByAThirdOfASecondTimesTheSpeed) {
  BodyBench bench(kBare, "{}");
  const double speed = 0.05;
  for (int i = 0; i < 300; ++i) {
    bench.target.array() += speed * Body::kPeriod;
    bench.hold(Body::kPeriod);
  }
  // The set-point is a staircase, so the lag varies by half a step.
  const baxter::Joints lag = bench.target - bench.body.joints();
  for (double one : lag) EXPECT_NEAR(one, speed * Body::kLag, speed * Body::kPeriod);
  const RobotMessages said = bench.body.messages();
  for (double one : said.speed) EXPECT_NEAR(one, speed, 1e-4);
}

TEST(FakeBody, GoesAtItsShareOfTheGreatestSpeedHoweverFarTheSetPointJumps) {
  BodyBench as_shipped(kBare, "{}");
  BodyBench as_left(kBare, "{}", [](auto& o) { o.speed_ratio = 0.03; });
  BodyBench set_by_command(kBare, "{}");
  set_by_command.body.set_speed_ratio(1.0);
  set_by_command.body.set_speed_ratio(std::numeric_limits<double>::quiet_NaN());
  for (const auto& [bench, share] : {std::pair(&as_shipped, 0.3), {&as_left, 0.03}, {&set_by_command, 1.0}}) {
    bench->target(1) -= 1.5 * share;
    for (int i = 0; i < 100; ++i) {
      bench->hold(Body::kPeriod);
      EXPECT_LT(bench->body.messages().speed.cwiseAbs().maxCoeff(), 1.5 * share * (1 + 1e-9));
    }
    EXPECT_LT(bench->body.messages().speed(1), -1.0 * share);
  }
}

TEST(FakeBody, HoldsWhenCommandsStopFor200Milliseconds) {
  BodyBench bench(kBare, "{}");
  bench.lead({0.115, 0.115, 0.10}, 0.03);
  bench.wait(0.19);
  EXPECT_EQ(bench.body.mode(), Body::Mode::following);
  bench.wait(0.01);
  EXPECT_EQ(bench.body.mode(), Body::Mode::timed_out);
  bench.wait(3.0);
  const baxter::Joints held = bench.body.joints();
  bench.wait(3.0);
  EXPECT_LT((bench.body.joints() - held).cwiseAbs().maxCoeff(), 1e-4);
  bench.body.set_command_timeout(1.0);
  bench.body.command(bench.target);
  bench.wait(0.9);
  EXPECT_EQ(bench.body.mode(), Body::Mode::following);
}

TEST(FakeBody, PressesByItsStiffnessTimesTheDepth) {
  BodyBench bench(kBare, kQuiet);
  bench.lead({0.115, 0.115, 0.01}, 0.05);
  bench.hold(2.0);
  const double zero = bench.force().z();
  EXPECT_EQ(bench.body.pressing(), 0.0);
  bench.lead({0.115, 0.115, -0.005}, 0.01);
  bench.hold(3.0);
  EXPECT_NEAR(bench.body.tip().z(), -0.005, 1e-5);
  EXPECT_NEAR(bench.body.pressing(), 1500 * 0.005, 0.02);
  // The bias depends on the pose, which has changed.
  EXPECT_NEAR(bench.force().z() - zero, -7.5, 1.0) << "pressed upwards it falls";
}

TEST(FakeBody, GivesWayWithAnArmThatDoesAndTheJointsShowIt) {
  BodyBench bench(kBare, "{stiffness: {object: 1500 N/m, arm: 1000 N/m}, force_noise: {deviation: 0 N}}");
  bench.lead({0.115, 0.115, -0.01}, 0.02);
  bench.hold(3.0);
  const double force = 0.01 / (1.0 / 1500 + 1.0 / 1000);
  EXPECT_NEAR(bench.body.pressing(), force, 0.05);
  EXPECT_NEAR(bench.body.tip().z(), -force / 1500, 1e-4) << "as deep as the object gives way";
  EXPECT_NEAR(bench.body.set_point_height(), -0.01, 1e-5);
}

TEST(FakeBody, TouchesTheSceneWhereItsTipIs) {
  BodyBench bench(kObjectI, kQuiet);
  const double top = bench.scene->height(0.1, 0.08);
  ASSERT_GT(top, 0.06);
  bench.lead({0.1, 0.08, 0.15}, 0.1);
  bench.hold(2.0);
  bench.lead({0.1, 0.08, 0.0}, 0.02, [&] { return bench.body.pressing() > 3.0; });
  EXPECT_NEAR(bench.body.tip().z(), top - 3.0 / 1500, 3e-4);
}

TEST(FakeBody, TheFirmwareHoldsItForTwoSecondsAbove16NewtonsAndThenItGoesOn) {
  BodyBench bench(kBare, kQuiet);
  bench.lead({0.115, 0.115, -0.03}, 0.05, [&] { return bench.reflex(); });
  ASSERT_TRUE(bench.reflex());
  const double begin = bench.body.now();
  EXPECT_GT(bench.body.pressing(), Body::kReflex);
  EXPECT_LT(bench.body.pressing(), Body::kReflex + 1.5);
  bench.jump({0.115, 0.115, 0.05});
  while (bench.reflex()) {
    EXPECT_TRUE(bench.body.messages().collision->collision);
    EXPECT_LT(bench.body.tip().z(), 0.0) << "commands are ignored";
    bench.hold(Body::kPeriod);
  }
  EXPECT_NEAR(bench.body.now() - begin, Body::kHeld, 0.011);
  EXPECT_FALSE(bench.body.messages().collision->collision);
  bench.hold(3.0);
  EXPECT_NEAR(bench.body.tip().z(), 0.05, 1e-4);
}

TEST(FakeBody, LeftPressingItIsHeldAgainAndAgainAndALittleWayUpEachTimeSetsItFree) {
  BodyBench bench(kBare, kQuiet);
  bench.lead({0.115, 0.115, -0.03}, 0.1, [&] { return bench.reflex(); });
  bench.hold(0.5);
  ASSERT_GT(bench.body.pressing(), Body::kReflex);
  int fired = 0;
  bool before = true;
  const auto watch = [&](double seconds) {
    for (double left = seconds; left > 0.0; left -= Body::kPeriod) {
      bench.hold(Body::kPeriod);
      EXPECT_EQ(bench.body.messages().collision->collision, bench.reflex());
      fired += bench.reflex() && !before ? 1 : 0;
      before = bench.reflex();
    }
  };
  watch(4.5 * Body::kHeld);
  EXPECT_EQ(fired, 4) << "the set-point is still below";
  EXPECT_GT(bench.body.pressing(), Body::kReflex);
  bench.jump({0.115, 0.115, 0.05});
  watch(10 * Body::kHeld);
  EXPECT_FALSE(bench.reflex());
  EXPECT_NEAR(bench.body.tip().z(), 0.05, 1e-4);
}

TEST(FakeBody, AnEmergencyStopNeedsItsButtonReleasedThenAResetAndThenEnable) {
  BodyBench bench;
  bench.inject("estop=1");
  bench.hold(0.5);
  EXPECT_EQ(bench.body.mode(), Body::Mode::stopped);
  EXPECT_EQ(bench.state().estop_button, State::Button::pressed);
  bench.body.reset();
  EXPECT_TRUE(bench.state().stopped) << "refused while it is pressed";
  bench.hold(0.6);
  EXPECT_EQ(bench.state().estop_button, State::Button::released);
  bench.body.enable(true);
  EXPECT_FALSE(bench.state().enabled);
  bench.body.reset();
  EXPECT_FALSE(bench.state().stopped);
  EXPECT_FALSE(bench.state().enabled);
  bench.hold(0.1);
  EXPECT_EQ(bench.body.mode(), Body::Mode::disabled);
  bench.body.enable(true);
  bench.hold(0.1);
  EXPECT_EQ(bench.body.mode(), Body::Mode::following);
}

/// Returns the state as text: an upper-case letter per set flag and a lower-case one per unset flag, then button and
/// source as numbers.
std::string in_letters(const State& state) {
  return fmt::format("{}{}{}{} {} {}", state.ready ? "R" : "r", state.enabled ? "E" : "e", state.stopped ? "S" : "s",
                     state.error ? "X" : "x", static_cast<int>(state.estop_button),
                     static_cast<int>(state.estop_source));
}

TEST(FakeBody, IsReadyOnlyWhileItIsEnabledAndStoppedByAnythingButItsButtonDoesNotKnowTheButton) {
  BodyBench bench(kBare, kQuiet);
  const std::pair<const char*, const char*> script[] = {
      {"enable", "REsx 0 0"},
      {"disable", "resx 0 0"},
      {"enable", "REsx 0 0"},
      {"error", "reSX 2 3"},
      {"enable", "reSX 2 3"},
      {"reset", "resx 0 0"},
      {"enable", "REsx 0 0"},
      {"stop", "reSx 2 2"},
      {"reset", "resx 0 0"},
      // An error of a component, which Rethink's tools call non-fatal.
      {"complaint", "resX 0 0"},
      {"enable", "REsX 0 0"},
      {"reset", "resX 0 0"},
      {"enable", "REsX 0 0"}};
  for (const auto& [act, state] : script) {
    const std::string word = act;
    if (word == "enable" || word == "disable") {
      bench.body.enable(word == "enable");
    } else if (word == "reset") {
      bench.body.reset();
    } else {
      bench.inject(word);
    }
    EXPECT_EQ(in_letters(bench.state()), state) << word;
    bench.hold(0.1);
    const Body::Mode held = state[2] == 'S' ? Body::Mode::stopped : Body::Mode::disabled;
    EXPECT_EQ(bench.body.mode(), state[0] == 'R' ? Body::Mode::following : held) << word;
  }
  bench.lead({0.115, 0.115, 0.10}, 0.05);
  bench.hold(2.0);
  EXPECT_NEAR(bench.body.tip().z(), 0.10, 1e-4) << "a complaint stops nothing";
}

TEST(FakeBody, AFaultBeginsOnTheDescentAndAtTheHeightAskedFor) {
  BodyBench bench(kBare, kQuiet);
  bench.inject("error", "2:8cm");
  for (int descent = 1; descent <= 2; ++descent) {
    bench.lead({0.115, 0.115, 0.12}, 0.2);
    bench.hold(2.0);
    EXPECT_FALSE(bench.body.faulty());
    bench.lead({0.115, 0.115, 0.05}, 0.05, [&] { return bench.body.faulty(); });
    if (descent == 1) bench.hold(2.0);
    EXPECT_EQ(bench.body.faulty(), descent == 2);
  }
  EXPECT_NEAR(bench.body.tip().z(), 0.08, 0.001);
  EXPECT_TRUE(bench.body.messages().state->error);
  const double height = bench.body.tip().z();
  bench.hold(2.0);
  EXPECT_NEAR(bench.body.tip().z(), height, 0.001) << "brakes";
}

TEST(FakeBody, SaysWhatItsFaultsMakeOfIt) {
  const auto said = [](const std::string& fault) {
    BodyBench bench;
    bench.hold(0.5);
    bench.inject(fault);
    const RobotMessages before = bench.body.messages();
    bench.hold(0.5);
    return std::make_pair(before, bench.body.messages());
  };
  EXPECT_FALSE(said("kill_endpoint").second.endpoint);
  EXPECT_FALSE(said("no_data=endpoint").second.endpoint);
  EXPECT_FALSE(said("kill_joints").second.joints);
  EXPECT_FALSE(said("kill_state").second.state);
  EXPECT_FALSE(said("no_data=collision").second.collision);
  EXPECT_TRUE(said("nan_wrench").second.endpoint->force.array().isNaN().all());
  EXPECT_TRUE(said("zero_wrench").second.endpoint->force.isZero(0.0));
  EXPECT_FALSE(said("disabled").second.state->enabled);
  EXPECT_TRUE(said("squish").second.collision->collision);
  const auto frozen = said("freeze_endpoint");
  EXPECT_EQ(frozen.first.endpoint->force, frozen.second.endpoint->force);
  EXPECT_GT(frozen.second.endpoint->stamp, frozen.first.endpoint->stamp);
  const auto stale = said("stale_stamps");
  EXPECT_NE(stale.first.endpoint->force, stale.second.endpoint->force);
  EXPECT_EQ(stale.second.endpoint->stamp, stale.first.endpoint->stamp);
  EXPECT_EQ(stale.second.joints->stamp, stale.first.joints->stamp);
  const auto jump = said("jump_joints=0.4");
  const auto none = said("bias=-12");
  EXPECT_NEAR(jump.second.joints->position(1) - none.second.joints->position(1), 0.4, 1e-9);
  EXPECT_NEAR(none.second.endpoint->force.z() - jump.second.endpoint->force.z(), 12.0, 1e-9);
}

TEST(FakeBody, OfWhichTheToolIsCaughtPullsByItsSpringAndTheArmsAndIsHeldByItsFirmware) {
  BodyBench bench(kBare, kQuiet);
  bench.inject("caught=3000");
  bench.lead({0.115, 0.115, 0.03}, 0.05);
  bench.hold(2.0);
  EXPECT_EQ(bench.body.pressing(), 0.0) << "before a contact nothing holds it";
  bench.lead({0.115, 0.115, -0.002}, 0.01);
  bench.hold(2.0);
  EXPECT_NEAR(bench.body.pressing(), 3.0, 0.02);
  const double zero = bench.force().z() + 3.0;
  bench.lead({0.115, 0.115, 0.005}, 0.01);
  bench.hold(3.0);
  const double pull = 3000.0 * bench.body.tip().z();
  EXPECT_NEAR(bench.body.pressing(), -pull, 0.01 * pull) << "the arm gives way to the side, too";
  EXPECT_GT(pull, 5.0);
  EXPECT_LT(pull, 3000.0 * 0.005) << "the arm gives way";
  EXPECT_NEAR(bench.force().z() - zero, pull, 1.0) << "pulled it rises";
  bench.lead({0.115, 0.115, 0.05}, 0.05, [&] { return bench.reflex(); });
  EXPECT_LT(bench.body.pressing(), -Body::kReflex);
  bench.body.release();
  bench.hold(3.0);
  EXPECT_EQ(bench.body.pressing(), 0.0);
}

}  // namespace
}  // namespace palpate::test
