// SPDX-License-Identifier: MIT
// One tap after the other on a robot in the same process: what is measured, how hard it presses, and in which state
// whatever goes wrong leaves the arm.
#include "baxter/tapper.hpp"
#include "baxter/body_robot.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace palpate::baxter {
namespace {

using fake_baxter::Body;
using fake_baxter::FaultKind;
using palpate::test::wave_scene;
using test::BodyRobot;
using test::fake_options;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;
using Type = tapping::MotionOptions::Type;

constexpr double kHover = 0.135;
constexpr double kPi = 3.14159265358979323846;
const Target kOnObject{0.115, 0.115};
const Target kOnDesk{0.03, 0.03};

/// A robot over the paper's object I and the driver for it.
class Bench {
 public:
  explicit Bench(const BaxterOptions& options = fake_options(), const BaxterOptions& truth = fake_options(),
                 const std::function<void(test::BodyOptions&)>& change = nullptr)
      : options_(options),
        robot(wave_scene(), changed(truth, change)),
        tapper_(options, wave_scene(), robot, &interrupted,
                [this](const std::string& line) { notes.push_back(line); }) {}

  Contact tap(const Target& place) {
    TapRequest request;
    request.number = ++taps_;
    request.target = place;
    request.previous = previous_;
    previous_ = place;
    return tapper_.tap(request);
  }
  void check() { tapper_.check(); }
  double tip() const { return robot.body.tip().z(); }

  std::atomic<bool> interrupted{false};
  std::vector<std::string> notes;

 private:
  static test::BodyOptions changed(const BaxterOptions& truth, const std::function<void(test::BodyOptions&)>& change) {
    test::BodyOptions out = test::body_options(truth);
    if (change) change(out);
    return out;
  }
  BaxterOptions options_;

 public:
  BodyRobot robot;

 private:
  Tapper tapper_;
  int taps_ = 0;
  std::optional<Target> previous_;
};

TEST(ATap, FindsTheObjectAndTheDeskAndEndsAtTheHeightOfTravel) {
  Bench bench;
  bench.check();
  for (const Target& place : {kOnObject, kOnDesk, Target{0.115, 0.05}, Target{0.2, 0.21}}) {
    const Contact contact = bench.tap(place);
    ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
    EXPECT_NEAR(contact.height, wave_scene().height(place.x, place.y), 0.002);
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
    EXPECT_GT(contact.force, 6.0);
    EXPECT_LT(contact.force, Body::kReflex);
    EXPECT_GT(contact.seconds, 2.0);
    EXPECT_LT(contact.seconds, 20.0);
    EXPECT_EQ(contact.reason, "");
  }
}

TEST(ATap, CanBeMadeInEveryMotion) {
  for (const Type type : {Type::paper, Type::two_stage, Type::continuous}) {
    BaxterOptions options = fake_options();
    options.motion.type = type;
    Bench bench(options);
    double hardest = 0.0;
    bench.robot.every_period = [&] { hardest = std::max(hardest, bench.robot.body.pressing()); };
    for (const Target& place : {kOnObject, kOnDesk}) {
      const Contact contact = bench.tap(place);
      ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
      // Where the arm rests, the object has given way by the force over 1500 N/m.
      EXPECT_NEAR(contact.height, wave_scene().height(place.x, place.y), type == Type::continuous ? 0.002 : 0.01);
    }
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
  Bench bench(fake_options(), fake_options(),
              [](test::BodyOptions& body) { body.start_at = Eigen::Vector3d(0.02, 0.02, -0.002); });
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
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  // Seconds without commands: the arm is in nobody's hand, and another program drives it elsewhere above the area.
  const test::PlannerBench plans;
  const Joints elsewhere = plans.at(0.2, 0.05, 0.2);
  for (int i = 0; i < 500; ++i) {
    bench.robot.body.command(elsewhere);
    bench.robot.wait_until(bench.robot.body.now() + 0.01);
  }
  const Contact contact = bench.tap(kOnObject);
  ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
  EXPECT_NEAR(contact.height, wave_scene().height(kOnObject.x, kOnObject.y), 0.002);
}

TEST(ATap, OutOfReachMovesNothing) {
  BaxterOptions far = fake_options();
  far.place.corner[0] = 0.9;
  Bench bench(far);
  const Contact contact = bench.tap({0.23, 0.0});
  EXPECT_EQ(contact.outcome, Outcome::unreachable);
  EXPECT_THAT(contact.reason, StartsWith("no position of the joints"));
  EXPECT_FALSE(contact.ends_run);
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(ATap, ThatMeetsNothingEndsAboveTheFloor) {
  BaxterOptions options = fake_options();
  options.place.height += 0.1;  // the desk lies 10 cm lower than the config has it
  options.motion.timeout = 60;
  Bench bench(options);
  const Contact contact = bench.tap(kOnDesk);
  EXPECT_EQ(contact.outcome, Outcome::no_contact);
  EXPECT_FALSE(contact.ends_run);
  EXPECT_GT(*std::min_element(bench.robot.heights.begin(), bench.robot.heights.end()), 0.1 - 0.03);
}

TEST(ATap, InterruptedIsAbortedAndTheArmRaised) {
  for (const double at : {0.13, 0.12, 0.1095}) {  // on the way down, and pressing
    Bench bench;
    bench.robot.every_period = [&] {
      if (bench.tip() < at) bench.interrupted = true;
    };
    const Contact contact = bench.tap(kOnObject);
    EXPECT_EQ(contact.outcome, Outcome::aborted);
    EXPECT_EQ(contact.reason, "interrupted; the arm was raised to the height of travel");
    EXPECT_FALSE(contact.ends_run);
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
  }
}

TEST(ATap, WithTheForceOfTheOtherSignIsStoppedAndSaysWhatToSet) {
  BaxterOptions options = fake_options();
  options.force_sign = BaxterOptions::ForceSign::negative;
  Bench bench(options);
  const Contact contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr("force_sign is wrong"));
  EXPECT_NEAR(bench.tip(), kHover, 0.01);
}

TEST(ADryRun, CommandsNothing) {
  BaxterOptions options = fake_options();
  options.dry_run = true;
  Bench bench(options, fake_options(), [](test::BodyOptions& body) { body.start = fake_baxter::Start::tucked; });
  bench.robot.body.inject({FaultKind::tucked, 0.0, {}});
  bench.check();
  const Contact contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, StartsWith("dry run"));
  EXPECT_TRUE(bench.robot.commands.empty());
  EXPECT_THAT(bench.notes.front(), HasSubstr("all 169 places of the area can be reached"));
}

TEST(ACalibrationTap, PutsTheZeroWhereTheDeskIs) {
  BaxterOptions options = fake_options();
  options.place.height += 0.006;  // measured too high
  options.calibration.emplace();
  options.calibration->at[0] = options.calibration->at[1] = 0.02;
  Bench bench(options);
  const Contact contact = bench.tap(kOnObject);
  ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
  EXPECT_NEAR(contact.height, wave_scene().height(kOnObject.x, kOnObject.y), 0.002);
  EXPECT_NEAR(bench.tap(kOnDesk).height, 0.0, 0.002) << "once is enough";
}

TEST(ACalibrationTap, EndsTheRunWhereTheDeskIsNotNearWhereTheConfigHasIt) {
  BaxterOptions options = fake_options();
  options.calibration.emplace();
  options.calibration->at[0] = options.calibration->at[1] = 0.115;  // on the object
  Bench bench(options);
  const Contact contact = bench.tap(kOnDesk);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_THAT(contact.reason, HasSubstr("cm higher than place.height has it"));
}

// --- Faults
// ------------------------------------------------------------------------------------------------------------

enum class Arm_ { held, raised };

struct Trouble {
  FaultKind kind;
  double amount;
  const char* reason;
  Arm_ arm;
  bool ends_run;
};

void PrintTo(const Trouble& trouble, std::ostream* out) { *out << trouble.reason; }

class TroubleInATap : public testing::TestWithParam<Trouble> {};

TEST_P(TroubleInATap, LeavesTheArmSafeWithinFiveSeconds) {
  const Trouble& trouble = GetParam();
  Bench bench;
  bench.check();
  ASSERT_EQ(bench.tap(kOnDesk).outcome, Outcome::contact);
  bench.robot.body.inject({trouble.kind, trouble.amount, {}}, {1, 0.125});  // on the way down to the object at 11 cm
  double since = 0.0;
  double lowest = 1.0;
  bench.robot.every_period = [&] {
    if (since == 0.0 && bench.robot.body.faulty()) since = bench.robot.body.now();
    lowest = std::min(lowest, bench.tip());
  };
  const Contact contact = bench.tap(kOnObject);
  const double took = bench.robot.body.now() - since;
  ASSERT_GT(since, 0.0) << "it never happened";
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_THAT(contact.reason, HasSubstr(trouble.reason));
  EXPECT_EQ(contact.ends_run, trouble.ends_run);
  EXPECT_LT(took, trouble.ends_run ? 5.0 : 10.0);
  // What the arm does when nobody sends anything any more is the firmware's: nothing.
  const double left_at = bench.tip();
  for (int i = 0; i < 300; ++i) bench.robot.body.step();
  EXPECT_NEAR(bench.tip(), left_at, 0.005) << "it stands";
  if (trouble.arm == Arm_::raised) {
    EXPECT_THAT(contact.reason,
                testing::AnyOf(EndsWith("the arm was raised to the height of travel"), HasSubstr("its zero moved")));
    EXPECT_NEAR(bench.tip(), kHover, 0.01);
  } else {
    EXPECT_THAT(contact.reason, testing::AnyOf(HasSubstr("nothing more is sent"), HasSubstr("the arm holds")));
    EXPECT_LT(bench.tip(), 0.127);
  }
  EXPECT_LT(bench.robot.body.pressing(), Body::kReflex);
}

INSTANTIATE_TEST_SUITE_P(
    OnTheWayDown, TroubleInATap,
    testing::Values(
        Trouble{FaultKind::estop, 2, "the emergency stop is pressed", Arm_::held, true},
        Trouble{FaultKind::error, 0, "the robot reports an error", Arm_::held, true},
        Trouble{FaultKind::squish, 0, "the arm's own reflex stopped it", Arm_::raised, true},
        Trouble{FaultKind::freeze_endpoint, 0, "the same force to the last digit", Arm_::held, true},
        Trouble{FaultKind::kill_endpoint, 0, "endpoint_state of the left arm did not come", Arm_::held, true},
        Trouble{FaultKind::kill_joints, 0, "joint_states of the left arm did not come", Arm_::held, true},
        Trouble{FaultKind::kill_state, 0, "/robot/state did not come", Arm_::held, true},
        Trouble{FaultKind::stale_stamps, 0, "its data are stale", Arm_::held, true},
        Trouble{FaultKind::second_state, 0, "more than one node", Arm_::held, true},
        Trouble{FaultKind::nan_wrench, 0, "no number", Arm_::held, true},
        Trouble{FaultKind::zero_wrench, 0, "exactly zero", Arm_::held, true},
        Trouble{FaultKind::bias, 12, "its zero moved", Arm_::raised, false},
        Trouble{FaultKind::bias, 20, "more than force_stop allows", Arm_::raised, true},
        Trouble{FaultKind::bias, -12, "the force fell by more than the threshold", Arm_::raised, true},
        Trouble{FaultKind::drop_commands, 5, "the arm does not follow", Arm_::held, true},
        Trouble{FaultKind::jump_joints, 0.3, "jumped by", Arm_::held, true},
        Trouble{FaultKind::freeze_clock, 0, "the clock of the robot's network stands still", Arm_::held, true}),
    [](const auto& trouble) { return "Number" + std::to_string(trouble.index); });

// --- The robot's own inverse kinematics -----------------------------------------------------------------------------

BaxterOptions asking() {
  BaxterOptions out = fake_options();
  out.inverse_kinematics = BaxterOptions::InverseKinematics::robot;
  return out;
}

TEST(TheRobotsInverseKinematics, IsAskedForEveryPose) {
  Bench bench(asking());
  const Contact contact = bench.tap(kOnObject);
  ASSERT_EQ(contact.outcome, Outcome::contact) << contact.reason;
  EXPECT_NEAR(contact.height, wave_scene().height(kOnObject.x, kOnObject.y), 0.002);
  EXPECT_GT(bench.robot.asked, 30);
}

TEST(TheRobotsInverseKinematics, IsNotBelieved) {
  const Arm gripper({0, 0, 0.025});
  const auto expect_unreachable = [](const std::function<Robot::Answer(const Pose&, const Joints&)>& answer) {
    Bench bench(asking());
    bench.robot.answer = answer;
    const Contact contact = bench.tap(kOnObject);
    EXPECT_EQ(contact.outcome, Outcome::unreachable) << contact.reason;
    EXPECT_TRUE(bench.robot.commands.empty());
  };
  expect_unreachable([](const Pose&, const Joints&) { return Robot::Answer{}; });
  expect_unreachable([](const Pose&, const Joints&) {
    return Robot::Answer{Joints::Constant(std::numeric_limits<double>::quiet_NaN()), {}};
  });
  expect_unreachable([&](const Pose& pose, const Joints& seed) {  // another place
    Pose off = pose;
    off.position.z() += 0.002;
    return Robot::Answer{gripper.solve(off, seed), {}};
  });
  expect_unreachable([&](const Pose& pose, const Joints& seed) {  // beyond a limit
    Robot::Answer out{gripper.solve(pose, seed), {}};
    if (out.joints) (*out.joints)(6) += 2.0 * kPi;
    return out;
  });
}

TEST(TheRobotsInverseKinematics, EndsTheRunBeforeAnythingMovesWhenItDoesNotAnswer) {
  Bench bench(asking());
  bench.robot.answer = [](const Pose&, const Joints&) { return Robot::Answer{{}, "IKService did not answer"}; };
  const Contact contact = bench.tap(kOnObject);
  EXPECT_EQ(contact.outcome, Outcome::aborted);
  EXPECT_TRUE(contact.ends_run);
  EXPECT_THAT(contact.reason, StartsWith("IKService did not answer"));
  EXPECT_TRUE(bench.robot.commands.empty());
}

// --- Before flight
// ----------------------------------------------------------------------------------------------------

void expect_refused(Bench& bench, const std::string& reason) {
  try {
    bench.check();
    FAIL() << "expected: " << reason;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
    EXPECT_EQ(error.kind(), Error::Kind::run);
  }
  EXPECT_TRUE(bench.robot.commands.empty());
}

TEST(BeforeFlight, AGripperThatTheConfigDoesNotKnowIsNamedWithItsLength) {
  BaxterOptions truth = fake_options();
  truth.tool.gripper = 0.1585;
  Bench bench(fake_options(), truth);
  expect_refused(bench,
                 "tool.gripper: the robot has left_gripper 15.85 cm from left_hand, the config has it at 2.50 cm");
}

TEST(BeforeFlight, AnArmBesideTheAreaIsRefused) {
  Bench bench(fake_options(), fake_options(),
              [](test::BodyOptions& body) { body.start_at = Eigen::Vector3d(-0.12, 0.1, 0.2); });
  expect_refused(bench, "more than 10 cm beside the area, bring the tool by hand to a place above the area");
}

TEST(BeforeFlight, AToolThatDoesNotPointDownIsRefused) {
  Bench bench;
  Joints leaning = bench.robot.body.joints();
  leaning(5) -= 0.5;
  for (int i = 0; i < 500; ++i) {
    bench.robot.body.command(leaning);
    bench.robot.wait_until(bench.robot.body.now() + 0.01);
  }
  expect_refused(bench, "the tool does not point down");
}

TEST(BeforeFlight, AStateInWhichItMustNotMoveIsNamed) {
  const std::vector<std::pair<FaultKind, const char*>> cases{
      {FaultKind::disabled, "the robot is disabled: enable it"},
      {FaultKind::zero_wrench, "a force of exactly zero"},
      {FaultKind::second_state, "more than one node, /realtime_loop and /mock_robot"},
      {FaultKind::estop, "the emergency stop is pressed"},
      {FaultKind::error, "the robot reports an error"},
  };
  for (const auto& [kind, reason] : cases) {
    Bench bench;
    bench.robot.body.inject({kind, 100.0, {}});
    bench.robot.wait_until(bench.robot.body.now() + 0.1);
    expect_refused(bench, reason);
  }
}

}  // namespace
}  // namespace palpate::baxter
