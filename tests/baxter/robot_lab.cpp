// SPDX-License-Identifier: MIT
#include "robot_lab.hpp"

#include "baxter/ros/graph.hpp"
#include "support/ports.hpp"
#include "support/programs.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <set>
#include <stdexcept>
#include <thread>

#include <sys/resource.h>

namespace palpate::test {
namespace {

constexpr int kAttempts = 5;
constexpr double kProcessTimeout = 300.0;  // s until a program must have started or ended
constexpr const char* kTrace = "trace.csv";

/// The master at a port of this machine, and the deadline of its answers.
baxter::Master master_at(int port) { return baxter::Master(baxter::look_up("127.0.0.1", port, {})); }
baxter::Deadline soon() { return baxter::Steady::now() + std::chrono::seconds(5); }

/// Polls until `holds` is true or the program has ended, because the progress of another process causes no event.
template <class Condition>
bool comes_up(const Child& child, const Condition& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kProcessTimeout);
  while (child.running() && std::chrono::steady_clock::now() < end) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // interval between two checks
  }
  return false;
}

}  // namespace

std::filesystem::path fake_baxter_file() { return program_file().parent_path() / "tests/fake_baxter/fake_baxter"; }
std::filesystem::path probe_file() { return program_file().parent_path() / "tests/fake_baxter/baxter_probe"; }

RobotLab::RobotLab(const std::vector<std::string>& robot) {
  // A real robot has its own computer, and its driver rightly stops if this one is too busy. So the programs of this
  // test get a higher priority, if permitted.
  ::setpriority(PRIO_PROCESS, 0, -10);
  int attempts = 1;
  while (!start_master()) {
    if (++attempts > kAttempts) throw std::runtime_error("no ROS master comes up: " + master_->err());
  }
  if (!robot.empty()) start_robot(robot);
}

RobotLab::~RobotLab() {
  if (robot_ && robot_->pid() > 0) end_robot();
  if (!master_) return;
  master_->signal(SIGTERM);
  master_->wait(kProcessTimeout);
}

bool RobotLab::start_master() {
  port_ = free_port();
  master_ = start({"/usr/bin/python3", "/usr/bin/rosmaster", "--core", "-p", std::to_string(port_),
                   "--master-logger-level", "fatal"});
  // Another master may have taken the port meanwhile and would also answer, so the process is compared.
  return comes_up(*master_, [&] {
    try {
      return master_at(port_).process_id(soon()) == master_->pid();
    } catch (const baxter::NetworkError&) {
      return false;
    }
  });
}

std::vector<std::string> RobotLab::environment() const {
  return {"ROS_MASTER_URI=http://127.0.0.1:" + std::to_string(port_),
          "ROS_IP=127.0.0.1",
          "ROS_HOME=" + (folder() / "ros").string(),
          "ROS_LOG_DIR=" + (folder() / "ros" / "log").string(),
          "ROS_HOSTNAME",
          "ROS_NAMESPACE",
          "PYTHONPATH"};
}

std::vector<std::string> RobotLab::nodes() const {
  const baxter::Graph graph = master_at(port_).graph(soon());
  std::set<std::string> found;
  for (const auto* all : {&graph.publishers, &graph.subscribers, &graph.services}) {
    for (const auto& [name, nodes] : *all) found.insert(nodes.begin(), nodes.end());
  }
  return {found.begin(), found.end()};
}

void RobotLab::start_robot(const std::vector<std::string>& words) {
  std::vector<std::string> all{fake_baxter_file().string(), "--trace", (folder() / kTrace).string()};
  all.insert(all.end(), words.begin(), words.end());
  robot_ = start(all);
  const auto ready = [&] { return ("\n" + robot_->out()).find("\nready\n") != std::string::npos; };
  if (!comes_up(*robot_, ready)) throw std::runtime_error("the robot does not come up: " + robot_->err());
}

Ended RobotLab::end_robot() {
  robot_->signal(SIGTERM);
  // Moved out first, so that robot_ is empty also after an exception.
  const std::unique_ptr<Child> robot = std::move(robot_);
  return robot->wait(kProcessTimeout);
}

std::vector<Cells> RobotLab::trace() const {
  const std::string text = text_of(folder() / kTrace);
  return csv_rows(text.substr(0, text.find_last_of('\n') + 1));  // a running robot may be writing a row
}

std::unique_ptr<Child> RobotLab::start(const std::vector<std::string>& words) const {
  return std::make_unique<Child>(words, folder(), environment());
}

std::unique_ptr<Child> RobotLab::start_palpate(std::vector<std::string> words) const {
  words.insert(words.begin(), program_file().string());
  return start(words);
}

Ended RobotLab::palpate(const std::vector<std::string>& words, double limit) const {
  return start_palpate(words)->wait(limit);
}

Ended RobotLab::probe(std::vector<std::string> words) const {
  words.insert(words.begin(), probe_file().string());
  return start(words)->wait(kLimit);
}

}  // namespace palpate::test
