// SPDX-License-Identifier: MIT
// Whole runs on the robot of the tests, over a real master: what is reconstructed, and what is left when the program is
// killed, interrupted, or somebody has to see to the robot.
#include "robot_lab.hpp"
#include "robot_words.hpp"
#include "support/programs.hpp"
#include "support/sanitizers.hpp"
#include "support/terminal.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace palpate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

std::vector<std::string> outcomes(const fs::path& run) {
  std::vector<std::string> out;
  for (const Row& row : results(run)) out.push_back(field(row, "outcome"));
  return out;
}

/// Looks until the only run has so many lines in its log; another process writes it.
bool logged(const fs::path& runs, int lines) {
  return eventually([&] {
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(runs, none)) {
      if (entry.path().filename() != "taps.jsonl") continue;
      const std::string text = text_of(entry.path());
      return std::count(text.begin(), text.end(), '\n') >= lines;
    }
    return false;
  });
}

/// Looks until the robot's tip has come below `height` (m).
bool low(const RobotLab& lab, double height) {
  return eventually([&] {
    const std::vector<Cells> trace = lab.trace();
    return !trace.empty() && std::stod(trace.back().at("z")) < height;
  });
}

double last_height(const RobotLab& lab) { return std::stod(lab.trace().back().at("z")); }

/// Set-points that the robot has had, once a second of its time has passed in which more would have shown.
int commanded(const RobotLab& lab) {
  const auto rows = [&] { return lab.trace().size(); };
  const std::size_t before = rows();
  EXPECT_TRUE(eventually([&] { return rows() >= before + 100; }));
  return std::stoi(lab.trace().back().at("commands"));
}

/// Root of the mean squared error of the height mean over the places that truly lie on the object, as rmse_height_m is
/// defined; `truth` is a surface.csv with the truth.
double rmse_height(const fs::path& surface, const fs::path& truth) {
  const std::vector<Cells> cells = csv_rows(text_of(surface));
  const std::vector<Cells> known = csv_rows(text_of(truth));
  EXPECT_EQ(cells.size(), known.size());
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(cells[i].at("x"), known[i].at("x"));
    const double height = std::stod(known[i].at("true_height"));
    if (!(height > 0.01)) continue;
    sum += std::pow(std::stod(cells[i].at("height_mean")) - height, 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(RobotRun, ReconstructsObjectIAsTheSimulatorDoesWithTheSameEffects) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const Ended ended = lab.palpate({"run", object_i(), "backend=fake_baxter", "--runs", "robot"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "") << "ROS keeps to itself";
  EXPECT_THAT(ended.out, HasSubstr("done: tap budget after 17 taps"));
  const fs::path run = only_run(lab.folder() / "robot");
  EXPECT_EQ(outcomes(run), std::vector<std::string>(17, "contact"));

  const Ended simulated =
      lab.palpate({"run", object_i(), "scene=object_i_arm", "backend=continuous", "backend.motion.speed=2cm/s",
                   "backend.motion.threshold=6N", "--runs", "simulator"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const fs::path other = only_run(lab.folder() / "simulator");
  const double on_robot = rmse_height(run / "surface.csv", other / "surface.csv");
  const double in_simulator = rmse_height(other / "surface.csv", other / "surface.csv");
  RecordProperty("rmse_height_mm_robot", std::to_string(1e3 * on_robot));
  RecordProperty("rmse_height_mm_simulator", std::to_string(1e3 * in_simulator));
  EXPECT_NEAR(on_robot, in_simulator, 0.005);

  const std::optional<Row> summary = parse_json_row(text_of(run / "summary.json"));
  for (const char* name : {"rmse_m", "rmse_on_surface_m", "rmse_height_m", "footprint_iou", "nlpd", "coverage_95"}) {
    EXPECT_EQ(field(*summary, name), "") << name << ": a robot knows no truth";
  }
  EXPECT_THAT(lab.nodes(), ElementsAre("/end_effector_publisher", "/realtime_loop")) << "the program has signed off";
  lab.end_robot();
  for (const Cells& row : lab.trace())
    ASSERT_LT(std::stod(row.at("force")), 16.0) << "the firmware would have stopped it";
}

TEST(RobotRun, WorksInRealTimeAsWell) {
  if (kThreadSanitized) GTEST_SKIP() << "ten times slower, it does not keep up with a robot's 100 messages a second";
  RobotLab lab;
  // Low, and above the desk, where the first tap of this seed goes: it takes seconds.
  lab.start_robot({object_i(), "backend=fake_baxter", "scene=object_i_arm", "--start-at", "0.04,0.07,0.07"});
  const Ended ended = lab.palpate(run_words(1, {"backend.motion.hover=6cm"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(outcomes(only_run(lab.folder() / "runs")), ElementsAre("contact"));
}

TEST(RobotRun, TapsWithAnArmThatHasMassesSpringsAndFriction) {
  RobotLab lab;
  lab.start_robot(robot_words({"--arm", "springs", "--friction", "0.05"}));
  const Ended ended = lab.palpate(run_words(1));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(outcomes(only_run(lab.folder() / "runs")), ElementsAre("contact"));
}

TEST(RobotRun, IsReplayedToTheLastDigitWithoutTheRobot) {
  RobotLab lab;
  lab.start_robot(robot_words());
  ASSERT_EQ(lab.palpate(run_words(4)).status, 0);
  lab.end_robot();
  const Ended replay = lab.palpate({"replay", only_run(lab.folder() / "runs").string()});
  EXPECT_EQ(replay.status, 0) << replay.out << replay.err;
}

TEST(RobotRun, KilledInATapLeavesTheArmHoldingAndIsResumedWithTheTapUnknown) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const std::unique_ptr<Child> program = lab.start_palpate(run_words(4));
  ASSERT_TRUE(logged(lab.folder() / "runs", 3)) << "tap 2 is announced";
  ASSERT_TRUE(low(lab, 0.07)) << "on the way down";
  program->signal(SIGKILL);
  program->wait();
  const fs::path run = only_run(lab.folder() / "runs");
  ASSERT_TRUE(eventually([&] { return lab.trace().back().at("mode") == "timed_out"; })) << "by its own time-out";
  EXPECT_LT(last_height(lab), 0.07);

  const Ended resumed = lab.palpate({"resume", run.string(), "--quiet"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "unknown", "contact", "contact"));
}

/// How often the tip came down from the height of travel, by the robot's own account.
int descents(const RobotLab& lab) {
  int out = 0;
  bool up = false;
  for (const Cells& row : lab.trace()) {
    const double z = std::stod(row.at("z"));
    if (z > 0.125) up = true;
    if (z > 0.11 || !up) continue;
    up = false;
    ++out;
  }
  return out;
}

TEST(RobotRun, KilledAgainAndAgainMakesNoTapTwiceAndLosesNone) {
  const char* wanted = std::getenv("PALPATE_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 3;
  const int taps = 2 * kills + 3;
  RobotLab lab;
  lab.start_robot(robot_words());
  Random random(5, "run_test");
  const fs::path runs = lab.folder() / "runs";
  const auto begun = [&] {
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(runs, none)) {
      if (entry.path().filename() == "config.yaml") return true;
    }
    return false;
  };
  const auto next_words = [&]() -> std::vector<std::string> {
    if (!begun()) return run_words(taps);
    return {"resume", only_run(runs).string(), "--quiet"};
  };
  const auto lines = [&] {
    const std::string text = begun() ? text_of(only_run(runs) / "taps.jsonl") : "";
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  };
  for (int i = 0; i < kills; ++i) {
    const int before = lines();
    const std::unique_ptr<Child> program = lab.start_palpate(next_words());
    // A quarter of the kills comes at any moment of the start, the others in or between taps.
    if (random.uniform() > 0.25) {
      ASSERT_TRUE(logged(runs, before + 1 + (i % 2))) << program->err();
    }
    // The very subject is a kill at a moment that nothing announces.
    std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int>(random.uniform() * 1'000'000)));
    ASSERT_TRUE(program->running()) << "it was to be killed, not to end: " << program->err();
    program->signal(SIGKILL);
    program->wait();
  }
  const Ended last = lab.palpate(next_words(), 3000.0);
  ASSERT_EQ(last.status, 0) << last.err;
  lab.end_robot();

  int number = 0;
  int contacts = 0;
  for (const Row& row : results(only_run(runs))) {
    EXPECT_EQ(field(row, "tap"), std::to_string(++number)) << "none lost, none twice";
    contacts += field(row, "outcome") == "contact" ? 1 : 0;
  }
  EXPECT_EQ(number, taps);
  EXPECT_GE(contacts, taps - kills) << "at most one a kill is unknown";
  EXPECT_GE(descents(lab), contacts) << "each was made";
  EXPECT_LE(descents(lab), taps) << "none was made twice";
  RecordProperty("kills", kills);
  RecordProperty("contacts", contacts);
  RecordProperty("unknown", taps - contacts);
  RecordProperty("descents", descents(lab));
}

TEST(RobotRun, InterruptedHoldsRaisesTheArmLogsTheTapAndIsResumed) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const std::unique_ptr<Child> program = lab.start_palpate(run_words(4));
  ASSERT_TRUE(logged(lab.folder() / "runs", 3));
  ASSERT_TRUE(low(lab, 0.07));
  program->signal(SIGINT);
  const Ended ended = program->wait(300.0);
  EXPECT_EQ(ended.status, 130) << ended.err;
  const fs::path run = only_run(lab.folder() / "runs");
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "aborted"));
  EXPECT_EQ(field(results(run).back(), "reason"), "interrupted; the arm was raised to the height of travel");
  EXPECT_NEAR(last_height(lab), 0.135, 0.011);
  EXPECT_THAT(lab.nodes(), ElementsAre("/end_effector_publisher", "/realtime_loop"));

  const Ended resumed = lab.palpate({"resume", run.string(), "--quiet"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "aborted", "contact", "contact"));
}

TEST(RobotRun, StepByStepMovesTheArmAfterEnterAndNotBefore) {
  RobotLab lab;
  lab.start_robot(robot_words());
  std::vector<std::string> words{program_file().string(), "run", object_i(), "backend=fake_baxter", "taps=2", "--step",
                                 "initial.count=2"};
  Terminal terminal(words, lab.folder(), lab.environment());
  ASSERT_TRUE(terminal.shows("Enter taps, q ends: ")) << terminal.screen();
  EXPECT_THAT(terminal.screen(), HasSubstr("tap 1 of 2 at ("));
  EXPECT_THAT(terminal.screen(), HasSubstr("stop at 5.0 N above the tare: a contact\r\n"
                                           "      stop whatever it does when the force changes by 14.0 N upwards"));
  EXPECT_EQ(commanded(lab), 0);
  EXPECT_EQ(text_of(only_run(lab.folder() / "runs") / "taps.jsonl"), "") << "no tap is announced";
  terminal.type("\n");
  ASSERT_TRUE(terminal.shows("Enter taps, q ends: ", 2)) << terminal.screen();
  const int moves = commanded(lab);
  EXPECT_GT(moves, 0);
  terminal.type(std::string(1, Terminal::kControlC));
  EXPECT_EQ(terminal.wait(), 130) << terminal.screen();
  EXPECT_EQ(commanded(lab), moves) << "nothing was sent for the second tap";
  const fs::path run = only_run(lab.folder() / "runs");
  EXPECT_THAT(outcomes(run), ElementsAre("contact"));

  const Ended resumed = lab.palpate({"resume", run.string(), "--quiet"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "contact"));
}

TEST(RobotRun, IsRefusedWhileAnotherProgramCommandsTheArm) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const std::unique_ptr<Child> other = lab.start({probe_file().string(), "drive", "1000", "0"});
  ASSERT_TRUE(eventually([&] {
    const std::vector<Cells> trace = lab.trace();
    return !trace.empty() && trace.back().at("mode") == "following";
  }));
  const Ended ended = lab.palpate(run_words(1), 60.0);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("the arm is commanded by /probe"));
  EXPECT_FALSE(fs::exists(lab.folder() / "runs"));
}

TEST(RobotRun, RaisesTheArmWhenItsTerminalIsClosedWhichMaySayItTwice) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const std::unique_ptr<Child> program = lab.start_palpate(run_words(4));
  ASSERT_TRUE(logged(lab.folder() / "runs", 3));
  ASSERT_TRUE(low(lab, 0.07));
  program->signal(SIGHUP);
  program->signal(SIGHUP);
  EXPECT_EQ(program->wait(300.0).status, 130);
  EXPECT_THAT(outcomes(only_run(lab.folder() / "runs")), ElementsAre("contact", "aborted"));
  EXPECT_NEAR(last_height(lab), 0.135, 0.011);
}

TEST(RobotRun, CarriesOnAfterAFaultOnceSomebodyHasSeenToTheRobot) {
  RobotLab lab;
  lab.start_robot(robot_words({"--fault", "estop=1", "--at", "2:8cm"}));
  const Ended failed = lab.palpate(run_words(4));
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("the emergency stop is pressed"));
  const fs::path run = only_run(lab.folder() / "runs");
  const Ended too_early = lab.palpate({"resume", run.string(), "--retry-failed", "--quiet"});
  EXPECT_EQ(too_early.status, 1);
  EXPECT_THAT(too_early.err, HasSubstr("the emergency stop was pressed and is released: reset it (rosrun"));
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "aborted")) << "what is refused before it moves is no tap";
  ASSERT_THAT(lab.probe({"switches"}).out, EndsWith("enable: ready 1 enabled 1 stopped 0 error 0 button 0 source 0\n"));
  const Ended resumed = lab.palpate({"resume", run.string(), "--retry-failed", "--quiet"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(outcomes(run), ElementsAre("contact", "aborted", "contact", "contact"));
}

TEST(RobotRun, RecordsARosbagAndADiaryBesideItsTaps) {
  RobotLab lab;
  lab.start_robot(robot_words());
  ASSERT_EQ(lab.palpate(run_words(1, {"backend.bag=true"})).status, 0);
  const fs::path run = only_run(lab.folder() / "runs");
  EXPECT_THAT(text_of(run / "baxter.txt"), HasSubstr("\ntap 1: contact at "));
  const Ended bag = lab.probe({"bag", (run / "baxter.bag").string()});
  ASSERT_EQ(bag.status, 0) << bag.err;
  for (const char* line :
       {"/robot/limb/left/endpoint_state baxter_core_msgs/EndpointState 44bea01d596ff699fa1447bec34167ac",
        "/robot/joint_states sensor_msgs/JointState 3066dcd76a6cfaef579bd0f34173e9fd",
        "/robot/state baxter_core_msgs/AssemblyState 356d9dd237ce73b2667da9235f541933",
        "/robot/limb/left/joint_command baxter_core_msgs/JointCommand 19bfec8434dd568ab3c633d187c36f2e",
        "/palpate/surface sensor_msgs/PointCloud2 1158d486dd51d683ce2f1be655c3c181",
        "/palpate/taps visualization_msgs/MarkerArray"}) {
    EXPECT_THAT(bag.out, HasSubstr(line));
  }
}

TEST(RobotRun, IsRefusedWhileAnotherMovesTheArmWhichGoesOn) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const std::unique_ptr<Child> first = lab.start_palpate(run_words(3));
  ASSERT_TRUE(logged(lab.folder() / "runs", 1));
  const Ended second = lab.palpate(run_words(2, {"seed=2"}));
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.err, HasSubstr("joint_command: another palpate moves this arm, the node /palpate_"));
  EXPECT_EQ(lab.palpate(run_words(2, {"seed=2", "backend.dry_run=true", "--runs", "dry"})).status, 0)
      << "moves nothing";
  const Ended ended = first->wait();
  EXPECT_EQ(ended.status, 0) << ended.err;
}

TEST(RobotSweep, TapsOneJobAfterTheOtherHoweverManyMayRunAtATime) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const Ended ended = lab.palpate(
      {"sweep", object_i(), "backend=fake_baxter", "taps=2", "initial.count=2", "seed=1,2", "-j", "2", "--quiet"});
  ASSERT_EQ(ended.status, 0) << ended.err;
}

TEST(RobotRun, AsksTheRobotsInverseKinematicsIfItIsToldTo) {
  RobotLab lab;
  lab.start_robot(robot_words());
  const Ended ended = lab.palpate(run_words(2, {"backend.inverse_kinematics=robot"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(outcomes(only_run(lab.folder() / "runs")), ElementsAre("contact", "contact"));
}

TEST(RobotRun, CallsAPlaceUnreachableWhereTheRobotsInverseKinematicsHasNoAnswer) {
  RobotLab lab;
  lab.start_robot(robot_words({"--fault", "ik_invalid"}));
  const Ended ended = lab.palpate(run_words(2, {"backend.inverse_kinematics=robot"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(outcomes(only_run(lab.folder() / "runs")), ElementsAre("unreachable", "unreachable"));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

TEST(RobotRun, ComputesEveryPoseOfTheAreaInADryRunAndMovesNothing) {
  RobotLab lab;
  lab.start_robot(robot_words({"--fault", "disabled"}));
  const Ended ended = lab.palpate(run_words(2, {"backend.dry_run=true"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const fs::path run = only_run(lab.folder() / "runs");
  EXPECT_THAT(outcomes(run), ElementsAre("aborted", "aborted"));
  EXPECT_THAT(text_of(run / "baxter.txt"), StartsWith("dry run: all 169 places of the area can be reached"));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

}  // namespace
}  // namespace palpate::test
