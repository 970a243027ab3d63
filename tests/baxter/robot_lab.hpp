// SPDX-License-Identifier: MIT
// A ROS network for one test: a master on a free port of this machine, the robot of the tests, and programs that talk
// to it. Tests may run at the same time; none leaves anything running.
#pragma once

#include "support/support.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::test {

/// Programs of this build.
std::filesystem::path fake_baxter_file();
std::filesystem::path probe_file();

class RobotLab {
 public:
  /// Starts a master in a folder of its own and, with words, the robot. Throws std::runtime_error.
  explicit RobotLab(const std::vector<std::string>& robot = {});
  /// Ends the robot, then the master; what does not end is killed.
  ~RobotLab();
  RobotLab(const RobotLab&) = delete;
  RobotLab& operator=(const RobotLab&) = delete;

  /// The folder in which programs run.
  const std::filesystem::path& folder() const { return folder_.path(); }
  /// What a program needs to find the master, for test::Child.
  std::vector<std::string> environment() const;

  /// Starts fake_baxter with these words, and a trace, and waits until it is up. Throws std::runtime_error with what it
  /// said if it does not come up.
  void start_robot(const std::vector<std::string>& words);
  /// The robot's process; there must be one.
  Child& robot() { return *robot_; }
  /// Ends it by SIGTERM; what it left behind.
  Ended end_robot();
  /// What the robot did so far, a row a period, complete once it has ended: see Trace in fake_baxter/node.cpp.
  std::vector<Cells> trace() const;

  /// Starts a program in this network.
  std::unique_ptr<Child> start(const std::vector<std::string>& words) const;
  /// The same for palpate of this build; what takes longer than `limit` seconds is killed.
  std::unique_ptr<Child> start_palpate(std::vector<std::string> words) const;
  Ended palpate(const std::vector<std::string>& words, double limit = kLimit) const;
  /// And for the probe of these tests (probe.cpp), to its end.
  Ended probe(std::vector<std::string> words) const;

  /// The nodes that the master knows, sorted.
  std::vector<std::string> nodes() const;
  /// The master's process.
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
