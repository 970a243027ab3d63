// SPDX-License-Identifier: MIT
// All faults of the simulated robot, and the resulting state of arm, record and program.
#include "command_lines.hpp"
#include "fault_cases.hpp"
#include "robot_lab.hpp"
#include "support/programs.hpp"
#include "support/sanitizers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace palpate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

/// Waits until two seconds of robot time have passed since the last command, or the robot has ended.
void await_standstill(RobotLab& lab) {
  eventually([&] {
    if (!lab.robot().running()) return true;
    const std::vector<Cells> trace = lab.trace();
    return trace.size() > 200 && trace[trace.size() - 200].at("commands") == trace.back().at("commands");
  });
}

class FaultInATap : public testing::TestWithParam<FaultCase> {};

TEST_P(FaultInATap, LeavesTheArmSafeTheTapLoggedAndTheReasonNamed) {
  if (kSanitized) GTEST_SKIP() << "the driver meets the same faults in the same process, where sanitizers see it, too";
  const FaultCase& given = GetParam();
  RobotLab lab(robot_arguments({"--fault", given.fault, "--at", "2:8cm"}));
  const Ended ended = lab.palpate(run_arguments(2), 60.0);
  EXPECT_EQ(ended.status, given.ends_run ? 1 : 0) << ended.err;
  if (given.ends_run) {
    EXPECT_THAT(ended.err, HasSubstr(given.reason));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  }
  const std::vector<Row> taps = results(only_run(lab.folder() / "runs"));
  ASSERT_THAT(fields(taps, "outcome"), ElementsAre("contact", "aborted"));
  EXPECT_THAT(field(taps[1], "reason"), HasSubstr(given.reason));
  EXPECT_EQ(field(taps[1], "height"), "");

  await_standstill(lab);
  lab.end_robot();
  const std::vector<Cells> trace = lab.trace();
  const auto number = [&](std::size_t row, const char* name) { return std::stod(trace[row].at(name)); };
  const std::size_t last = trace.size() - 1;
  std::size_t began = 0;
  while (began <= last && trace[began].at("fault") == "0") ++began;
  ASSERT_LE(began, last) << "it never happened";
  double took = 0.0;
  double lowest = 1.0;
  for (std::size_t i = began; i <= last; ++i) {
    if (number(i, "commands") < number(last, "commands")) took = number(i, "t") - number(began, "t");
    lowest = std::min(lowest, number(i, "z"));
    EXPECT_LT(number(i, "force"), 16.0);
  }
  RecordProperty("seconds_of_robot_time", std::to_string(took));
  EXPECT_LT(took, 5.0) << "of the robot's time";
  EXPECT_NEAR(number(last, "z"), given.raised ? 0.135 : lowest, 0.011);
  if (std::string(given.fault) != "die") {
    EXPECT_NEAR(number(last, "z"), number(last - 49, "z"), 0.001) << "it stands";
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheRobot, FaultInATap, testing::ValuesIn(kFaultCases),
                         [](const auto& trouble) { return name_of(trouble.param); });
INSTANTIATE_TEST_SUITE_P(OfItsComputer, FaultInATap,
                         testing::Values(FaultCase{"RobotGone", "die", "the clock of the robot's network has stopped"}),
                         [](const auto& trouble) { return name_of(trouble.param); });

TEST(FaultOfInverseKinematics, EndsTheRunBeforeAnythingMoves) {
  RobotLab lab(robot_arguments({"--fault", "ik_slow=5"}));
  const Ended ended = lab.palpate(run_arguments(2, {"backend.inverse_kinematics=robot"}), 60.0);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("IKService"));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

struct BeforeFlight {
  const char* name;
  std::vector<std::string> robot;
  const char* reason;
  std::vector<std::string> run = {};
};

void PrintTo(const BeforeFlight& fault, std::ostream* out) { *out << fault.name; }

class FaultBeforeFlight : public testing::TestWithParam<BeforeFlight> {};

TEST_P(FaultBeforeFlight, IsRefusedInOneLineWithoutACommandAndWithoutARecord) {
  if (kSanitized) GTEST_SKIP() << "the checks meet the same faults in the same process, where sanitizers see them, too";
  RobotLab lab(robot_arguments(GetParam().robot));
  const Ended ended = lab.palpate(run_arguments(2, GetParam().run), 60.0);
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(GetParam().reason));
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  EXPECT_FALSE(std::filesystem::exists(lab.folder() / "runs"));
  EXPECT_THAT(lab.nodes(), IsSupersetOf({"/end_effector_publisher", "/realtime_loop"}));
  for (const std::string& node : lab.nodes()) EXPECT_THAT(node, Not(HasSubstr("palpate")));
  lab.end_robot();
  EXPECT_EQ(lab.trace().back().at("commands"), "0");
}

INSTANTIATE_TEST_SUITE_P(
    OfTheRobot, FaultBeforeFlight,
    testing::Values(
        BeforeFlight{"Disabled", {"--fault", "disabled"}, "the robot is disabled: enable it"},
        BeforeFlight{"Tucked", {"--fault", "tucked"}, "its arm is tucked"},
        BeforeFlight{"EmergencyStop", {"--fault", "estop=1000"}, "the emergency stop is pressed"},
        BeforeFlight{"ForceIsZero", {"--fault", "zero_wrench"}, "a force of exactly zero"},
        BeforeFlight{"SecondState",
                     {"--fault", "second_sender"},
                     "/robot/state: comes from more than one node, /realtime_loop and /second_robot, end the nodes "
                     "that are not the robot; rosnode cleanup removes ended ones"},
        BeforeFlight{
            "SecondEndpoint",
            {"--fault", "second_sender=endpoint"},
            "/robot/limb/left/endpoint_state: comes from more than one node, /realtime_loop and /second_robot"},
        BeforeFlight{"SecondCollision",
                     {"--fault", "second_sender=collision"},
                     "/robot/limb/left/collision_detection_state: comes from more than one node"},
        BeforeFlight{"SecondJoints",
                     {"--fault", "second_sender=joints"},
                     "/robot/joint_states of the left arm comes from more than one node"},
        BeforeFlight{"OldFirmware",
                     {"--fault", "old_state"},
                     "/robot/state: /realtime_loop sends baxter_core_msgs/AssemblyState with md5 sum "
                     "d7ff2b9fa7d5f688665ce44db4ee2af8, but this driver needs baxter_core_msgs/AssemblyState with "
                     "356d9dd237ce73b2667da9235f541933, install the robot's software 1.2"},
        BeforeFlight{
            "OldSoftware",
            {"--fault", "software=1.1.1.5"},
            "/rethink/software_version: the robot's software is 1.1.1.5, install software 1.2 on the robot, which this "
            "driver needs"},
        BeforeFlight{"NoEndpoint",
                     {"--fault", "no_data=endpoint"},
                     "/robot/limb/left/endpoint_state: /realtime_loop publishes it, but no message has arrived, check "
                     "it with rostopic echo; the robot may still be starting"},
        BeforeFlight{"NoJoints", {"--fault", "no_data=joints"}, "/robot/joint_states"},
        BeforeFlight{"NoInverseKinematics",
                     {"--fault", "ik_absent"},
                     "/ExternalTools/left/PositionKinematicsNode/IKService: no node offers this service, set "
                     "inverse_kinematics: own, or start the robot again",
                     {"backend.inverse_kinematics=robot"}},
        BeforeFlight{"BesideTheArea", {"--start-at", "-0.12,0.1,0.2"}, "more than 10 cm outside the area"},
        BeforeFlight{
            "OtherGripper", {"backend.tool.gripper=15.85cm"}, "the robot has left_gripper 15.85 cm from left_hand"}),
    [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace palpate::test
