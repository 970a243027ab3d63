// SPDX-License-Identifier: MIT
// Tests of the simulated robot on a real ROS network.
#include "command_lines.hpp"
#include "robot_lab.hpp"
#include "support/programs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <sstream>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <baxter_core_msgs/SolvePositionIK.h>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

/// A line of the probe's output, "sender topic size count rate", by its first three words.
struct StreamRate {
  long count;
  double rate;
};
std::map<std::string, StreamRate> heard(const RobotLab& lab, const std::string& seconds) {
  const Ended probe = lab.probe({"listen", seconds});
  EXPECT_EQ(probe.status, 0) << probe.err;
  std::map<std::string, StreamRate> out;
  std::istringstream lines(probe.out);
  std::string sender, topic, size;
  StreamRate one{};
  while (lines >> sender >> topic >> size >> one.count >> one.rate) out[sender + " " + topic + " " + size] = one;
  return out;
}

TEST(FakeRobot, ItsMessagesAreThoseOfARealRobotByTheirMd5Sums) {
  // Published by Rethink, and equal in code that others generated from its definitions.
  using namespace baxter_core_msgs;
  const std::pair<const char*, const char*> sums[] = {
      {ros::message_traits::md5sum<EndpointState>(), "44bea01d596ff699fa1447bec34167ac"},
      {ros::message_traits::md5sum<JointCommand>(), "19bfec8434dd568ab3c633d187c36f2e"},
      {ros::message_traits::md5sum<AssemblyState>(), "356d9dd237ce73b2667da9235f541933"},
      {ros::message_traits::md5sum<CollisionDetectionState>(), "7bde38c182b4d08fdc0635b116f65d04"},
      {ros::message_traits::md5sum<CollisionAvoidanceState>(), "30f5cb8ae019f1ffe8b599e6d2e589c7"},
      {ros::message_traits::md5sum<EndEffectorProperties>(), "21b83773ab9a35216d11e427573c76cc"},
      {ros::service_traits::md5sum<SolvePositionIK>(), "18cc92fd96853eb10b34de0b5c7d3cba"},
      {ros::message_traits::md5sum<SolvePositionIK::Request>(), "2587e42983d0081d0a2288230991073b"},
      {ros::message_traits::md5sum<SolvePositionIK::Response>(), "d9b0c2b3932e08421f5094cf62743b9f"}};
  for (const auto& [ours, theirs] : sums) EXPECT_STREQ(ours, theirs);
}

TEST(FakeRobot, PublishesItsStreamsAtTheirRatesFromTwoNodes) {
  RobotLab lab(robot_arguments());
  const auto streams = heard(lab, "10");
  // Rates are in the robot's time. With a queue of one message, some may be lost on a busy machine.
  const auto expect_rate = [&](const std::string& name, double rate) {
    ASSERT_EQ(streams.count(name), 1U) << name;
    EXPECT_GT(streams.at(name).rate, 0.7 * rate) << name;
    EXPECT_LT(streams.at(name).rate, 1.05 * rate) << name;
  };
  expect_rate("/realtime_loop /robot/limb/left/endpoint_state 1", 100);
  expect_rate("/realtime_loop /robot/joint_states 17", 100);
  expect_rate("/realtime_loop /robot/state 1", 100);
  expect_rate("/realtime_loop /robot/limb/left/collision_detection_state 1", 100);
  expect_rate("/realtime_loop /robot/limb/left/collision_avoidance_state 1", 10);
  expect_rate("/end_effector_publisher /robot/joint_states 1", 38);
  EXPECT_EQ(streams.size(), 6U);
}

TEST(FakeRobot, StopsResetsAndIsEnabledLikeARealOne) {
  RobotLab lab(robot_arguments());
  EXPECT_EQ(lab.probe({"switches"}).out,
            "stop: ready 0 enabled 0 stopped 1 error 0 button 2 source 2\n"
            "enable: ready 0 enabled 0 stopped 1 error 0 button 2 source 2\n"
            "reset: ready 0 enabled 0 stopped 0 error 0 button 0 source 0\n"
            "enable: ready 1 enabled 1 stopped 0 error 0 button 0 source 0\n");
}

TEST(FakeRobot, ItsTimeDoesNotRunAwayFromADriverOnABusyMachine) {
  RobotLab lab;
  std::vector<std::string> words = robot_arguments();
  words.back() = "20";
  // A driver may lose the processor for a while when other tests run, so the robot waits longer here.
  words.insert(words.end(), {"--patience", "1"});
  lab.start_robot(words);
  // A lateness of 5 ms is 100 ms of robot time at this rate, if the robot did not wait.
  EXPECT_EQ(lab.probe({"drive", "5", "0.005"}).out, "late 0\n");
  EXPECT_TRUE(eventually([&] { return lab.trace().back().at("mode") == "timed_out"; })) << "nobody drives any more";
  lab.end_robot();
  const std::vector<Cells> trace = lab.trace();
  const auto commands = [&](std::size_t row) { return std::stol(trace[row].at("commands")); };
  std::size_t first = 0;
  while (first < trace.size() && commands(first) == 0) ++first;
  std::size_t last = trace.size() - 1;
  while (last > first && commands(last) == commands(last - 1)) --last;
  ASSERT_GT(last, first + 400);
  for (std::size_t row = first; row <= last; ++row) {
    EXPECT_EQ(trace[row].at("mode"), "following") << row;
    // At most two periods ahead, unless the robot had waited for long.
    if (row > first + 3) {
      EXPECT_GT(commands(row), commands(row - 4)) << row;
    }
  }
}

TEST(FakeRobot, ASecondNodeMayClaimToBeTheRobotAndOldFirmwareIsNotUnderstood) {
  const RobotLab two(robot_arguments({"--fault", "second_sender=state"}));
  const auto states = heard(two, "5");
  EXPECT_EQ(states.count("/second_robot /robot/state 1"), 1U);
  EXPECT_EQ(states.count("/realtime_loop /robot/state 1"), 1U);
  const RobotLab old(robot_arguments({"--fault", "old_state"}));
  const auto streams = heard(old, "5");
  EXPECT_EQ(streams.count("/realtime_loop /robot/state 1"), 0U);
  EXPECT_EQ(streams.count("/realtime_loop /robot/joint_states 17"), 1U);
}

TEST(FakeRobot, RefusesWhatItDoesNotKnowInOneLine) {
  const auto refusal = [](std::vector<std::string> words) {
    words.insert(words.begin(), fake_baxter_file().string());
    const Ended ended = run_program(words, ".");
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    return ended.err;
  };
  EXPECT_THAT(refusal(robot_arguments({"--fault", "sulk"})), HasSubstr("there is no fault 'sulk'"));
  EXPECT_THAT(refusal(robot_arguments({"--fault", "spikes=2"})),
              HasSubstr("spikes takes a number from 0 to 1, not '2'"));
  EXPECT_THAT(refusal(robot_arguments({"--fault", "stall=-1"})), HasSubstr("stall takes a number from 0 on, not '-1'"));
  EXPECT_THAT(refusal(robot_arguments({"--at", "soon"})), HasSubstr("takes 'start' or DESCENT:HEIGHT"));
  EXPECT_THAT(refusal(robot_arguments({"--arm", "rubber"})), HasSubstr("--arm: "));
  EXPECT_THAT(refusal(robot_arguments({"--start-at", "0.1,0.1"})), HasSubstr("--start-at: "));
  EXPECT_THAT(refusal({robot_arguments().front()}), HasSubstr("add backend=fake_baxter"));
}

/// Returns the child processes of `pid`.
std::vector<long> children_of(long pid) {
  const std::string id = std::to_string(pid);
  std::istringstream words(text_of("/proc/" + id + "/task/" + id + "/children"));
  std::vector<long> out;
  for (long child = 0; words >> child;) out.push_back(child);
  return out;
}

TEST(FakeRobot, LeavesNothingRunningAndKilledTakesItsCompanionsAlong) {
  for (const bool killed : {false, true}) {
    std::vector<long> all;
    std::filesystem::path folder;
    {
      RobotLab lab(robot_arguments({"--fault", "second_sender=state"}));
      folder = lab.folder();
      all = children_of(lab.robot().pid());
      ASSERT_EQ(all.size(), 2U) << "nodes of their own";
      for (const long pid : all) EXPECT_TRUE(running(pid));
      if (killed) lab.robot().signal(SIGKILL);
      EXPECT_TRUE(!killed || eventually([&] { return !running(all[0]) && !running(all[1]); }));
      all.push_back(lab.robot().pid());
      all.push_back(lab.master_pid());
    }
    for (const long pid : all) EXPECT_FALSE(running(pid));
    EXPECT_FALSE(std::filesystem::exists(folder));
  }
}

}  // namespace
}  // namespace palpate::test
