// SPDX-License-Identifier: MIT
// A ROS network for one test: a master on a free port of this machine, the simulated robot, and programs that connect
// to it. Tests may run concurrently; none leaves a process running.
#pragma once

#include "support/support.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::test {

/// Return programs of this build.
std::filesystem::path fake_baxter_file();
std::filesystem::path probe_file();

class RobotLab {
 public:
  /// Starts a master in its own folder and, with arguments, the robot. Throws std::runtime_error.
  explicit RobotLab(const std::vector<std::string>& robot = {});
  /// Ends the robot, then the master; a process that does not end is killed.
  ~RobotLab();
  RobotLab(const RobotLab&) = delete;
  RobotLab& operator=(const RobotLab&) = delete;

  /// Returns the folder in which programs run.
  const std::filesystem::path& folder() const { return folder_.path(); }
  /// Returns the environment with which a program finds the master, for test::Child.
  std::vector<std::string> environment() const;

  /// Starts fake_baxter with these arguments and a trace, and waits until it is ready. Throws std::runtime_error with
  /// its output if it does not start.
  void start_robot(const std::vector<std::string>& words);
  /// Returns the robot's process, which must exist.
  Child& robot() { return *robot_; }
  /// Ends the robot by SIGTERM and returns its status and output.
  Ended end_robot();
  /// Returns the robot's trace so far, one row per period: see Trace in fake_baxter/node.cpp. It is complete after the
  /// robot has ended.
  std::vector<Cells> trace() const;

  /// Starts a program in this network.
  std::unique_ptr<Child> start(const std::vector<std::string>& words) const;
  /// Start palpate of this build. Programs that take longer than `limit` seconds are killed.
  std::unique_ptr<Child> start_palpate(std::vector<std::string> words) const;
  Ended palpate(const std::vector<std::string>& words, double limit = kLimit) const;
  /// Runs the probe of these tests (probe.cpp) to its end.
  Ended probe(std::vector<std::string> words) const;

  /// Returns the nodes that the master lists, sorted.
  std::vector<std::string> nodes() const;
  /// Returns the process id of the master.
  int master_pid() const { return master_->pid(); }

  static constexpr double kLimit = 300.0;

 private:
  bool start_master();

  TemporaryFolder folder_;
  int port_ = 0;
  std::unique_ptr<Child> master_;
  std::unique_ptr<Child> robot_;
};

}  // namespace palpate::test
