// SPDX-License-Identifier: MIT
// Whole runs on the simulated robot with a real master: reconstruction, and state after kills, interruptions and faults
// that need a person.
#include "command_lines.hpp"
#include "robot_lab.hpp"
#include "support/parts.hpp"
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
#include <set>
#include <thread>

#include <rosbag/bag.h>
#include <rosbag/view.h>

namespace palpate::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::StartsWith;

namespace fs = std::filesystem;

fs::path run_of(const RobotLab& lab) { return only_run(lab.folder() / "runs"); }

/// Returns the outcomes of all taps in the only run.
std::vector<std::string> outcomes(const RobotLab& lab) { return fields(results(run_of(lab)), "outcome"); }

/// Runs palpate, which must succeed.
void palpate_does(const RobotLab& lab, const std::vector<std::string>& words, double limit = 300.0) {
  const Ended ended = lab.palpate(words, limit);
  EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
}

std::vector<std::string> resume_arguments(const RobotLab& lab) { return {"resume", run_of(lab).string(), "--quiet"}; }

/// Returns the path of a file in any folder below `runs`, or an empty path.
fs::path found(const fs::path& runs, const char* name) {
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(runs, none)) {
    if (entry.path().filename() == name) return entry.path();
  }
  return {};
}

/// Returns the number of announcements and taps in the only run so far.
long lines(const RobotLab& lab) {
  const fs::path log = found(lab.folder() / "runs", "record.jsonl");
  const std::string text = log.empty() ? "" : test::lasting_part_of(log.parent_path());
  return std::count(text.begin(), text.end(), '\n');
}

/// Waits until the run has this number of lines; another process writes them.
bool logged(const RobotLab& lab, long wanted) {
  return eventually([&] { return lines(lab) >= wanted; });
}

/// Waits until the robot's tip is below `height` (m).
bool low(const RobotLab& lab, double height) {
  return eventually([&] {
    const std::vector<Cells> trace = lab.trace();
    return !trace.empty() && std::stod(trace.back().at("z")) < height;
  });
}

double last_height(const RobotLab& lab) { return std::stod(lab.trace().back().at("z")); }

/// Returns the number of received set-points after one more second of robot time, in which further ones would appear.
int commanded(const RobotLab& lab) {
  const auto rows = [&] { return lab.trace().size(); };
  const std::size_t before = rows();
  EXPECT_TRUE(eventually([&] { return rows() >= before + 100; }));
  return std::stoi(lab.trace().back().at("commands"));
}

/// Returns the RMSE of the height mean over positions that truly are on an object, as rmse_height_m is defined. `truth`
/// is a surface.csv with the truth.
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

TEST(RobotRun, ReconstructsObjectIAsTheSimulatorDoesWithTheSameEffectsAndIsReplayedToTheLastDigitWithoutTheRobot) {
  RobotLab lab(robot_arguments());
  const Ended ended = lab.palpate({"run", object_i(), "backend=fake_baxter"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "") << "ROS keeps to itself";
  EXPECT_THAT(ended.out, HasSubstr("done: tap budget after 17 taps"));
  const fs::path run = run_of(lab);
  EXPECT_EQ(outcomes(lab), std::vector<std::string>(17, "contact"));

  palpate_does(lab, {"run", object_i(), "scene=object_i_arm", "motion=continuous", "motion.speed=2cm/s",
                     "motion.threshold=6N", "--runs", "simulator"});
  const fs::path other = only_run(lab.folder() / "simulator");
  const double on_robot = rmse_height(run / "surface.csv", other / "surface.csv");
  const double in_simulator = rmse_height(other / "surface.csv", other / "surface.csv");
  RecordProperty("rmse_height_mm_robot", std::to_string(1e3 * on_robot));
  RecordProperty("rmse_height_mm_simulator", std::to_string(1e3 * in_simulator));
  EXPECT_NEAR(on_robot, in_simulator, 0.005);

  const std::optional<Row> summary = parse_json_row(text_of(run / "summary.json"));
  for (const char* name : {"rmse_m", "rmse_object_m", "rmse_height_m", "footprint_iou", "nlpd", "coverage_95"}) {
    EXPECT_EQ(field(*summary, name), "") << name << ": a robot knows no truth";
  }
  EXPECT_THAT(lab.nodes(), ElementsAre("/end_effector_publisher", "/realtime_loop")) << "the program has signed off";
  lab.end_robot();
  palpate_does(lab, {"replay", run.string()});
  for (const Cells& row : lab.trace())
    ASSERT_LT(std::stod(row.at("force")), 16.0) << "the firmware would have stopped it";
}

TEST(RobotRun, WorksInRealTimeAsWell) {
  if (kThreadSanitized) GTEST_SKIP() << "ten times slower, it does not keep up with a robot's 100 messages a second";
  RobotLab lab;
  // The tip starts low over the desk at the first tap's position; that tap takes seconds.
  lab.start_robot({object_i(), "backend=fake_baxter", "scene=object_i_arm", "--start-at", "0.04,0.07,0.07"});
  palpate_does(lab, run_arguments(1, {"motion.hover=6cm"}));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact"));
}

TEST(RobotRun, OfAnArmWithMassesSpringsAndFrictionIsRecordedInARosbagAndADiaryBesideItsTaps) {
  const RobotLab lab(robot_arguments({"--arm", "springs", "--friction", "0.05"}));
  palpate_does(lab, run_arguments(1, {"backend.bag=true"}));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact"));
  EXPECT_THAT(text_of(run_of(lab) / "baxter.txt"), HasSubstr("\ntap 1: contact at "));
  std::set<std::string> topics;
  const rosbag::Bag bag((run_of(lab) / "baxter.bag").string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    topics.insert(message.getTopic() + " " + message.getDataType() + " " + message.getMD5Sum());
  }
  EXPECT_THAT(
      topics,
      IsSupersetOf({"/robot/limb/left/endpoint_state baxter_core_msgs/EndpointState 44bea01d596ff699fa1447bec34167ac",
                    "/robot/joint_states sensor_msgs/JointState 3066dcd76a6cfaef579bd0f34173e9fd",
                    "/robot/state baxter_core_msgs/AssemblyState 356d9dd237ce73b2667da9235f541933",
                    "/robot/limb/left/joint_command baxter_core_msgs/JointCommand 19bfec8434dd568ab3c633d187c36f2e",
                    "/palpate/surface sensor_msgs/PointCloud2 1158d486dd51d683ce2f1be655c3c181"}));
  EXPECT_THAT(topics, Contains(StartsWith("/palpate/taps visualization_msgs/MarkerArray")));
}

TEST(RobotRun, KilledInATapLeavesTheArmHoldingAndIsResumedWithTheTapUnknown) {
  RobotLab lab(robot_arguments());
  const std::unique_ptr<Child> program = lab.start_palpate(run_arguments(4));
  ASSERT_TRUE(logged(lab, 3)) << "tap 2 is announced";
  ASSERT_TRUE(low(lab, 0.07)) << "on the way down";
  program->signal(SIGKILL);
  program->wait();
  ASSERT_TRUE(eventually([&] { return lab.trace().back().at("mode") == "timed_out"; })) << "by its own time-out";
  EXPECT_LT(last_height(lab), 0.07);

  palpate_does(lab, resume_arguments(lab));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact", "unknown", "contact", "contact"));
}

/// Returns the number of descents from the height of travel in the robot's trace.
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
  RobotLab lab(robot_arguments());
  Random random(5, "run_test");
  const auto next_words = [&] {
    return found(lab.folder() / "runs", "config.yaml").empty() ? run_arguments(taps) : resume_arguments(lab);
  };
  for (int i = 0; i < kills; ++i) {
    const long before = lines(lab);
    const std::unique_ptr<Child> program = lab.start_palpate(next_words());
    // A quarter of the kills occurs at any moment of the start, the others during or between taps.
    if (random.uniform() > 0.25) {
      ASSERT_TRUE(logged(lab, before + 1 + (i % 2))) << program->err();
    }
    // The kill must occur at a moment without any event.
    std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int>(random.uniform() * 1'000'000)));
    ASSERT_TRUE(program->running()) << "it was to be killed, not to end: " << program->err();
    program->signal(SIGKILL);
    program->wait();
  }
  palpate_does(lab, next_words(), 3000.0);
  lab.end_robot();

  int number = 0;
  int contacts = 0;
  for (const Row& row : results(run_of(lab))) {
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

TEST(RobotRun, InterruptedOrWithItsTerminalClosedHoldsRaisesTheArmLogsTheTapAndIsResumed) {
  // A closed terminal may send the signal twice.
  for (const std::vector<int>& signals : {std::vector<int>{SIGINT}, {SIGHUP, SIGHUP}}) {
    const RobotLab lab(robot_arguments());
    const std::unique_ptr<Child> program = lab.start_palpate(run_arguments(4));
    ASSERT_TRUE(logged(lab, 3));
    ASSERT_TRUE(low(lab, 0.07));
    for (const int signal : signals) program->signal(signal);
    const Ended ended = program->wait(300.0);
    EXPECT_EQ(ended.status, 130) << ended.err;
    EXPECT_THAT(outcomes(lab), ElementsAre("contact", "aborted"));
    EXPECT_EQ(field(results(run_of(lab)).back(), "reason"), "interrupted; the arm was raised to the height of travel");
    EXPECT_NEAR(last_height(lab), 0.135, 0.011);
    EXPECT_THAT(lab.nodes(), ElementsAre("/end_effector_publisher", "/realtime_loop"));
    palpate_does(lab, resume_arguments(lab));
    EXPECT_THAT(outcomes(lab), ElementsAre("contact", "aborted", "contact", "contact"));
  }
}

TEST(RobotRun, StepByStepMovesTheArmAfterEnterAndNotBefore) {
  RobotLab lab(robot_arguments());
  std::vector<std::string> words{program_file().string(), "run", object_i(), "backend=fake_baxter", "taps=2", "--step",
                                 "initial.count=2"};
  Terminal terminal(words, lab.folder(), lab.environment());
  ASSERT_TRUE(terminal.shows("Enter taps, q ends: ")) << terminal.screen();
  EXPECT_THAT(terminal.screen(), HasSubstr("tap 1 of 2 at ("));
  EXPECT_THAT(terminal.screen(), HasSubstr("stop at 5.0 N above the tare: a contact\r\n      press with at most "));
  EXPECT_THAT(terminal.screen(), HasSubstr("\r\n      stop the descent when the force changes by 14.0 N upwards"));
  EXPECT_EQ(commanded(lab), 0);
  EXPECT_EQ(test::lasting_part_of(run_of(lab)), "") << "no tap is announced";
  terminal.type("\n");
  ASSERT_TRUE(terminal.shows("Enter taps, q ends: ", 2)) << terminal.screen();
  const int moves = commanded(lab);
  EXPECT_GT(moves, 0);
  terminal.type(std::string(1, Terminal::kControlC));
  EXPECT_EQ(terminal.wait(), 130) << terminal.screen();
  EXPECT_EQ(commanded(lab), moves) << "nothing was sent for the second tap";
  EXPECT_THAT(outcomes(lab), ElementsAre("contact"));
  palpate_does(lab, resume_arguments(lab));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact", "contact"));
}

TEST(RobotRun, IsRefusedWhileAnotherProgramCommandsTheArm) {
  RobotLab lab(robot_arguments());
  const std::unique_ptr<Child> other = lab.start({probe_file().string(), "drive", "1000", "0"});
  ASSERT_TRUE(eventually([&] {
    const std::vector<Cells> trace = lab.trace();
    return !trace.empty() && trace.back().at("mode") == "following";
  }));
  const Ended ended = lab.palpate(run_arguments(1), 60.0);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("the arm is also commanded by /probe"));
  EXPECT_FALSE(fs::exists(lab.folder() / "runs"));
}

TEST(RobotRun, CarriesOnAfterAFaultOnceSomebodyHasSeenToTheRobot) {
  RobotLab lab(robot_arguments({"--fault", "estop=1", "--at", "2:8cm"}));
  const Ended failed = lab.palpate(run_arguments(4));
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("the emergency stop is pressed"));
  const std::vector<std::string> again{"resume", run_of(lab).string(), "--retry-failed", "--quiet"};
  const Ended too_early = lab.palpate(again);
  EXPECT_EQ(too_early.status, 1);
  EXPECT_THAT(too_early.err, HasSubstr("the emergency stop was pressed and is released: reset it (rosrun"));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact", "aborted")) << "what is refused before it moves is no tap";
  ASSERT_THAT(lab.probe({"switches"}).out, EndsWith("enable: ready 1 enabled 1 stopped 0 error 0 button 0 source 0\n"));
  palpate_does(lab, again);
  EXPECT_THAT(outcomes(lab), ElementsAre("contact", "aborted", "contact", "contact"));
}

TEST(RobotRun, IsRefusedWhileAnotherMovesTheArmWhichGoesOn) {
  RobotLab lab(robot_arguments());
  const std::unique_ptr<Child> first = lab.start_palpate(run_arguments(40));  // ended after the others were rejected
  ASSERT_TRUE(logged(lab, 1));
  const Ended second = lab.palpate(run_arguments(2, {"seed=2"}));
  EXPECT_EQ(second.status, 75);
  EXPECT_THAT(second.err, StartsWith(lab.environment().front() + ": the arm left of http://"));
  const Ended sweep = lab.palpate({"sweep", object_i(), "backend=fake_baxter", "taps=2", "initial.count=2", "seed=3,4",
                                   "--quiet", "--runs", "swept"});
  EXPECT_EQ(sweep.status, 1);
  EXPECT_THAT(sweep.err, StartsWith("job 0: " + lab.environment().front() + ": the arm left of http://"));
  EXPECT_THAT(sweep.out, HasSubstr("stopped for the reason above; correct it, then run: palpate resume "));
  EXPECT_THAT(sweep.out, Not(HasSubstr("--retry-failed"))) << "no job has failed";
  // Another machine has its own locks, as has another name of the robot.
  std::string master = lab.environment().front();
  master.replace(master.find("127.0.0.1"), 9, "localhost");
  std::vector<std::string> words{"/usr/bin/env", master, program_file().string()};
  for (const std::string& word : run_arguments(2, {"seed=2"})) words.push_back(word);
  const Ended third = Child(words, lab.folder(), lab.environment()).wait();
  EXPECT_EQ(third.status, 1);
  EXPECT_THAT(third.err, HasSubstr("joint_command: another palpate moves this arm, the node /palpate_"));
  palpate_does(lab, run_arguments(2, {"seed=2", "backend.dry_run=true", "--runs", "dry"}));  // a dry run moves nothing
  first->signal(SIGINT);
  const Ended ended = first->wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
}

TEST(RobotSweep, TapsOneJobAfterTheOtherHoweverManyMayRunAtATime) {
  const RobotLab lab(robot_arguments());
  palpate_does(
      lab, {"sweep", object_i(), "backend=fake_baxter", "taps=2", "initial.count=2", "seed=1,2", "-j", "2", "--quiet"});
}

TEST(RobotRun, AsksTheRobotsInverseKinematicsIfItIsToldTo) {
  const RobotLab lab(robot_arguments());
  palpate_does(lab, run_arguments(2, {"backend.inverse_kinematics=robot"}));
  EXPECT_THAT(outcomes(lab), ElementsAre("contact", "contact"));
}

TEST(RobotRun, CallsAPlaceUnreachableWhereTheRobotsInverseKinematicsHasNoAnswer) {
  RobotLab lab(robot_arguments({"--fault", "ik_invalid"}));
  palpate_does(lab, run_arguments(2, {"backend.inverse_kinematics=robot"}));
  EXPECT_THAT(outcomes(lab), ElementsAre("unreachable", "unreachable"));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

TEST(RobotRun, ComputesEveryPoseOfTheAreaInADryRunAndMovesNothing) {
  RobotLab lab(robot_arguments({"--fault", "disabled"}));
  palpate_does(lab, run_arguments(2, {"backend.dry_run=true"}));
  EXPECT_THAT(outcomes(lab), ElementsAre("aborted", "aborted"));
  EXPECT_THAT(text_of(run_of(lab) / "baxter.txt"), StartsWith("dry run: all 169 places of the area can be reached"));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

}  // namespace
}  // namespace palpate::test
