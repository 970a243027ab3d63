// SPDX-License-Identifier: MIT
// Messages of a robot other than its position: settings of other programs, mounted tool, and causes of silence.
#include "baxter/ros/connect.hpp"

#include "child_run.hpp"
#include "command_lines.hpp"
#include "robot_lab.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

using baxter::connect;
using baxter::ReceivedSetting;
using baxter::Robot;
using baxter::Snapshot;

/// Reads until `holds` is true for a snapshot, for at most five minutes.
template <class Condition>
Snapshot read_until(Robot& robot, const Condition& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  Snapshot out = robot.read();
  while (!holds(out) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // interval between two checks
    out = robot.read();
  }
  return out;
}

std::string words(const std::optional<ReceivedSetting>& setting) {
  return setting ? fmt::format("{} by {}", setting->value, setting->sender) : "not heard";
}

std::string words(const Snapshot& seen) {
  return fmt::format("ratio {}, time-out {}, other arm {}, objects {}, gripper '{}', mass {:.4f}",
                     words(seen.speed_ratio), words(seen.command_timeout), seen.avoidance->other_arm,
                     seen.avoidance->objects, seen.end_effector.product, seen.end_effector.mass.value_or(-1.0));
}

/// Returns a text about a robot started with these arguments, once `complete` is true.
template <class Condition>
std::string heard_of(const std::vector<std::string>& robot, const Condition& complete) {
  RobotLab lab(robot_arguments(robot));
  return run_in_child(lab.environment(), [&] { return words(read_until(*connect({}), complete)); }).printed;
}

TEST(Heard, AreTheSettingsOfAProgramThatIsStillThereAndWhatIsMounted) {
  EXPECT_EQ(heard_of({"--fault", "speed_ratio", "--fault", "command_timeout=0.05", "--fault", "avoid=pedestal",
                      "--gripper", "Electric Parallel Gripper", "--tool-mass", "0.8"},
                     [](const Snapshot& seen) {
                       return seen.speed_ratio && seen.command_timeout && seen.avoidance &&
                              !seen.end_effector.product.empty();
                     }),
            "ratio 0.03 by /other_program_set_speed_ratio, time-out 0.05 by /other_program_joint_command_timeout, "
            "other arm false, objects [\"pedestal\"], gripper 'Rethink Research Robot Electric Parallel Gripper', "
            "mass 0.8002");
}

TEST(Heard, OfAProgramThatHasGoneTheSettingsAreNot) {
  EXPECT_EQ(heard_of({"--speed-ratio", "0.03", "--command-timeout", "0.02", "--fault", "avoid=other_arm"},
                     [](const Snapshot& seen) { return seen.avoidance && seen.avoidance->other_arm; }),
            "ratio not heard, time-out not heard, other arm true, objects [], gripper '', mass 0.0002");
}

TEST(Heard, IsEveryMessageOnceByItsCount) {
  RobotLab lab(robot_arguments({"--fault", "slow_endpoint=25", "--fault", "slow_force=8"}));
  const ChildResult result = run_in_child(lab.environment(), [] {
    const auto robot = connect({});
    const Snapshot first = robot->read();
    const Snapshot last = read_until(*robot, [&](const Snapshot& seen) {
      return seen.endpoint->count >= first.endpoint->count + 50 && seen.state->count > first.state->count &&
             seen.collision && seen.avoidance;
    });
    const double rate = static_cast<double>(last.endpoint->count - first.endpoint->count) /
                        (last.endpoint->stamp - first.endpoint->stamp);
    const long renewed = last.endpoint->renewals - first.endpoint->renewals;
    return fmt::format(
        "{:.3f} a second, {} with another force, joints {}, collision {}", rate,
        std::abs(2 * renewed - (last.endpoint->count - first.endpoint->count)) <= 2 ? "half" : "not half",
        last.joints->count > first.joints->count, last.collision->count > 0);
  });
  EXPECT_EQ(result.printed, "25.000 a second, half with another force, joints true, collision true");
}

TEST(Heard, SilenceOfThisComputerIsToldFromThatOfTheRobot) {
  RobotLab lab;
  std::vector<std::string> real_time = robot_arguments();
  real_time.resize(real_time.size() - 2);
  lab.start_robot(real_time);
  const int robot_pid = lab.robot().pid();
  const ChildResult result = run_in_child(lab.environment(), [&] {
    const auto robot = connect({});
    const pid_t self = getpid();
    const pid_t sleeper = fork();
    if (sleeper == 0) {
      kill(self, SIGSTOP);
      usleep(300'000);  // duration of the stop
      kill(self, SIGCONT);
      _exit(0);
    }
    while (waitpid(sleeper, nullptr, 0) < 0 && errno == EINTR) {
    }
    const bool own = robot->read().own_gap >= 0.29;
    kill(robot_pid, SIGSTOP);
    const Snapshot silent = read_until(*robot, [](const Snapshot& seen) {
      const double age = seen.now - seen.endpoint->received;
      return age > 0.3 && seen.own_gap < 0.5 * age;
    });
    kill(robot_pid, SIGCONT);
    const bool theirs = silent.own_gap < 0.5 * (silent.now - silent.endpoint->received);
    return fmt::format("own {}, the robot's {}", own, theirs);
  });
  EXPECT_EQ(result.printed, "own true, the robot's true");
}

}  // namespace
}  // namespace palpate::test
