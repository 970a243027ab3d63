// SPDX-License-Identifier: MIT
// Everything that goes wrong with the robot of the tests, and the state in which that leaves the arm, the record and
// the program.
#include "robot_lab.hpp"
#include "robot_words.hpp"
#include "support/programs.hpp"
#include "support/sanitizers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

enum class Left { holding, raised };

struct MidTap {
  const char* name;
  const char* fault;   ///< as the robot takes it, in the second tap at 8 cm above the desk
  const char* reason;  ///< of the tap
  Left arm;
  int status;  ///< of the program
};

void PrintTo(const MidTap& fault, std::ostream* out) { *out << fault.fault; }

/// Looks until the robot has gone on for two seconds of its time after the last command, or is gone.
void await_standstill(RobotLab& lab) {
  eventually([&] {
    if (!lab.robot().running()) return true;
    const std::vector<Cells> trace = lab.trace();
    return trace.size() > 200 && trace[trace.size() - 200].at("commands") == trace.back().at("commands");
  });
}

class FaultInATap : public testing::TestWithParam<MidTap> {};

TEST_P(FaultInATap, LeavesTheArmSafeTheTapLoggedAndTheReasonNamed) {
  if (kSanitized) GTEST_SKIP() << "the driver meets the same faults in the same process, where sanitizers see it, too";
  const MidTap& given = GetParam();
  RobotLab lab;
  lab.start_robot(robot_words({"--fault", given.fault, "--at", "2:8cm"}));
  const Ended ended = lab.palpate(run_words(2), 60.0);
  EXPECT_EQ(ended.status, given.status) << ended.err;
  if (given.status != 0) {
    EXPECT_THAT(ended.err, HasSubstr(given.reason));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  }
  const std::vector<Row> taps = results(only_run(lab.folder() / "runs"));
  ASSERT_EQ(taps.size(), 2U);
  EXPECT_EQ(field(taps[0], "outcome"), "contact");
  EXPECT_EQ(field(taps[1], "outcome"), "aborted");
  EXPECT_THAT(field(taps[1], "reason"), HasSubstr(given.reason));
  EXPECT_EQ(field(taps[1], "height"), "");

  await_standstill(lab);
  lab.end_robot();
  const std::vector<Cells> trace = lab.trace();
  const auto number = [](const Cells& row, const char* name) { return std::stod(row.at(name)); };
  std::size_t began = 0;
  while (began < trace.size() && trace[began].at("fault") == "0") ++began;
  ASSERT_LT(began, trace.size()) << "it never happened";
  const double commands = number(trace.back(), "commands");
  double last_command = number(trace[began], "t");
  double lowest = 1.0;
  double hardest = 0.0;
  for (std::size_t i = began; i < trace.size(); ++i) {
    if (number(trace[i], "commands") < commands) last_command = number(trace[i], "t");
    lowest = std::min(lowest, number(trace[i], "z"));
    hardest = std::max(hardest, number(trace[i], "force"));
  }
  const double took = last_command - number(trace[began], "t");
  RecordProperty("seconds_of_robot_time", std::to_string(took));
  EXPECT_LT(took, 5.0) << "of the robot's time";
  EXPECT_LT(hardest, 16.0);
  const double end = number(trace.back(), "z");
  EXPECT_NEAR(end, given.arm == Left::raised ? 0.135 : lowest, 0.011);
  if (std::string(given.fault) != "die") {
    EXPECT_NEAR(end, number(trace[trace.size() - 50], "z"), 0.001) << "it stands";
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfTheRobot, FaultInATap,
    testing::Values(
        MidTap{"EmergencyStop", "estop", "the emergency stop is pressed", Left::holding, 1},
        MidTap{"ErrorFlag", "error", "the robot reports an error and is disabled", Left::holding, 1},
        MidTap{"Squish", "squish", "the arm's own reflex stopped it", Left::raised, 1},
        MidTap{"FrozenEndpoint", "freeze_endpoint", "the same force to the last digit", Left::holding, 1},
        MidTap{"KilledEndpoint", "kill_endpoint", "endpoint_state of the left arm did not come", Left::holding, 1},
        MidTap{"KilledJoints", "kill_joints", "joint_states of the left arm did not come", Left::holding, 1},
        MidTap{"KilledState", "kill_state", "/robot/state did not come", Left::holding, 1},
        MidTap{"StaleStamps", "stale_stamps", "its data are stale", Left::holding, 1},
        MidTap{"SecondState", "second_state", "comes from more than one node", Left::holding, 1},
        MidTap{"ForceIsNoNumber", "nan_wrench", "no number", Left::holding, 1},
        MidTap{"ForceIsZero", "zero_wrench", "a force of exactly zero", Left::holding, 1},
        MidTap{"BiasUp", "bias=8", "its zero moved during the tap", Left::raised, 0},
        MidTap{"BiasFarUp", "bias=20", "more than force_stop allows", Left::raised, 1},
        MidTap{"BiasDown", "bias=-12", "the force fell by more than the threshold", Left::raised, 1},
        MidTap{"DroppedCommands", "drop_commands=5", "the arm does not follow", Left::holding, 1},
        MidTap{"JumpOfTheJoints", "jump_joints=0.3", "/robot/joint_states jumped by", Left::holding, 1},
        MidTap{"FrozenClock", "freeze_clock", "the clock of the robot's network stands still", Left::holding, 1},
        MidTap{"RobotGone", "die", "the clock of the robot's network stands still", Left::holding, 1}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST(FaultOfInverseKinematics, EndsTheRunBeforeAnythingMoves) {
  RobotLab lab;
  lab.start_robot(robot_words({"--fault", "ik_slow=5"}));
  const Ended ended = lab.palpate(run_words(2, {"backend.inverse_kinematics=robot"}), 60.0);
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
  RobotLab lab;
  lab.start_robot(robot_words(GetParam().robot));
  const Ended ended = lab.palpate(run_words(2, GetParam().run), 60.0);
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
    testing::Values(BeforeFlight{"Disabled", {"--fault", "disabled"}, "the robot is disabled: enable it"},
                    BeforeFlight{"Tucked", {"--fault", "tucked"}, "its arm is tucked"},
                    BeforeFlight{"EmergencyStop", {"--fault", "estop=1000"}, "the emergency stop is pressed"},
                    BeforeFlight{"ForceIsZero", {"--fault", "zero_wrench"}, "a force of exactly zero"},
                    BeforeFlight{"SecondState", {"--fault", "second_state"}, "comes from more than one node"},
                    BeforeFlight{"OldFirmware", {"--fault", "old_state"}, "md5 sum d7ff2b9fa7d5f688665ce44db4ee2af8"},
                    BeforeFlight{"OldSoftware", {"--fault", "software=1.1.1"}, "the robot's software is 1.1.1"},
                    BeforeFlight{"NoEndpoint", {"--fault", "no_data=endpoint"}, "/robot/limb/left/endpoint_state"},
                    BeforeFlight{"NoJoints", {"--fault", "no_data=joints"}, "/robot/joint_states"},
                    BeforeFlight{"NoInverseKinematics",
                                 {"--fault", "ik_absent"},
                                 "IKService: nobody offers this service",
                                 {"backend.inverse_kinematics=robot"}},
                    BeforeFlight{"BesideTheArea", {"--start-at", "-0.12,0.1,0.2"}, "more than 10 cm beside the area"},
                    BeforeFlight{"OtherGripper",
                                 {"backend.tool.gripper=15.85cm"},
                                 "the robot has left_gripper 15.85 cm from left_hand"}),
    [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace palpate::test
