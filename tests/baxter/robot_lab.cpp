// SPDX-License-Identifier: MIT
#include "robot_lab.hpp"

#include "support/ports.hpp"
#include "support/programs.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <set>
#include <stdexcept>
#include <thread>

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace palpate::test {
namespace {

constexpr int kAttempts = 5;
constexpr double kPatience = 300.0;  // s for a program to come up or to end: only what hangs takes them
constexpr const char* kTrace = "trace.csv";

/// Sends `text` to a port of this machine and returns all that comes back; "" if nobody listens.
std::string ask(int port, const std::string& text) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval limit{5, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  const sockaddr_in address = address_of(port);
  std::string out;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::send(socket, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size())) {
    char buffer[4096];
    for (ssize_t size = 0; (size = ::recv(socket, buffer, sizeof buffer, 0)) > 0;) {
      out.append(buffer, static_cast<std::size_t>(size));
    }
  }
  ::close(socket);
  return out;
}

/// Looks again and again until `holds` or the program has ended; another process's progress is announced to nobody.
template <class Condition>
bool comes_up(const Child& child, const Condition& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience);
  while (child.running() && std::chrono::steady_clock::now() < end) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // between two looks, not for an outcome
  }
  return false;
}

}  // namespace

std::filesystem::path fake_baxter_file() { return program_file().parent_path() / "tests/fake_baxter/fake_baxter"; }
std::filesystem::path probe_file() { return program_file().parent_path() / "tests/fake_baxter/baxter_probe"; }

RobotLab::RobotLab() {
  // A robot has a computer of its own, and its driver rightly stops where the other one is too busy to hear it: what
  // this test starts goes before what else this machine does, where that is allowed.
  ::setpriority(PRIO_PROCESS, 0, -10);
  for (int i = 0; i < kAttempts; ++i) {
    if (start_master()) return;
  }
  throw std::runtime_error("no ROS master comes up: " + master_->err());
}

RobotLab::~RobotLab() {
  if (robot_ && robot_->pid() > 0) end_robot();
  kill_master();
}

bool RobotLab::start_master() {
  port_ = free_port();
  master_ = start({"/usr/bin/python3", "/usr/bin/rosmaster", "--core", "-p", std::to_string(port_),
                   "--master-logger-level", "fatal"});
  // Another master may have taken the port meanwhile, and would answer, too: it must be this one.
  const std::string pid = ">" + std::to_string(master_->pid()) + "<";
  return comes_up(*master_, [&] { return ask_master("getPid").find(pid) != std::string::npos; });
}

void RobotLab::kill_master() {
  if (!master_) return;
  master_->signal(SIGTERM);
  master_->wait(kPatience);
  master_.reset();
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

std::string RobotLab::ask_master(const std::string& method) const {
  const std::string body = "<?xml version='1.0'?><methodCall><methodName>" + method +
                           "</methodName><params><param><value><string>/lab</string></value></param></params>"
                           "</methodCall>";
  return ask(port_, "POST / HTTP/1.0\r\nContent-Type: text/xml\r\nContent-Length: " + std::to_string(body.size()) +
                        "\r\n\r\n" + body);
}

std::vector<std::string> RobotLab::nodes() const {
  // The answer has lists of [topic, [node, node ...]]: nodes stand in the lists that have no list inside.
  const std::string text = ask_master("getSystemState");
  const std::string open = "<array>";
  const std::string close = "</array>";
  std::set<std::string> found;
  for (std::size_t end = text.find(close); end != std::string::npos; end = text.find(close, end + 1)) {
    const std::size_t begin = text.rfind(open, end);
    if (text.substr(begin, end - begin).find(close) != std::string::npos) continue;
    for (std::size_t at = text.find("<string>", begin); at < end; at = text.find("<string>", at + 1)) {
      found.insert(text.substr(at + 8, text.find('<', at + 8) - at - 8));
    }
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
  // Moved out first, so that it is gone whatever a test did with it before.
  const std::unique_ptr<Child> robot = std::move(robot_);
  return robot->wait(kPatience);
}

std::vector<Cells> RobotLab::trace() const {
  const std::string text = text_of(folder() / kTrace);
  return csv_rows(text.substr(0, text.find_last_of('\n') + 1));  // a robot still there may be writing a row
}

std::unique_ptr<Child> RobotLab::start(const std::vector<std::string>& words) const {
  return std::make_unique<Child>(words, folder(), environment());
}

Ended RobotLab::run(const std::vector<std::string>& words, double limit) const { return start(words)->wait(limit); }

std::unique_ptr<Child> RobotLab::start_palpate(const std::vector<std::string>& words) const {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return start(all);
}

Ended RobotLab::palpate(const std::vector<std::string>& words, double limit) const {
  return start_palpate(words)->wait(limit);
}

Ended RobotLab::probe(const std::vector<std::string>& words, double limit) const {
  std::vector<std::string> all{probe_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return run(all, limit);
}

}  // namespace palpate::test
