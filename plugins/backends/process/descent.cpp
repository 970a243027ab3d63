// SPDX-License-Identifier: MIT
#include "process/descent.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::process {
namespace {

struct Process {
  pid_t pid = 0;
  pid_t parent = 0;
  bool ended = false;
};

/// All of this machine, as they are now.
std::vector<Process> processes() {
  std::vector<Process> out;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", none)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream in(entry.path() / "stat");
    std::string line;
    if (!std::getline(in, line)) continue;
    // PID (NAME) STATE PARENT ..., where the name may hold anything.
    const std::size_t behind = line.rfind(')');
    if (behind == std::string::npos || behind + 4 > line.size()) continue;
    const char state = line[behind + 2];
    out.push_back({static_cast<pid_t>(std::stol(name)), static_cast<pid_t>(std::atol(line.c_str() + behind + 4)),
                   state == 'Z' || state == 'X'});
  }
  return out;
}

bool carries(pid_t pid, const std::string& mark) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  const std::string all = '\0' + std::string(std::istreambuf_iterator<char>(in), {});
  return all.find('\0' + mark + '\0') != std::string::npos;
}

}  // namespace

Descent::Descent() {
  static std::atomic<int> count{0};
  mark_ = "PALPATE_PROGRAM=" + std::to_string(::getpid()) + "." + std::to_string(++count);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
}

std::vector<pid_t> Descent::look(pid_t program) {
  const std::vector<Process> all = processes();
  std::vector<pid_t> fresh;
  found_.insert(program);
  for (std::size_t before = 0; before != found_.size();) {
    before = found_.size();
    for (const Process& one : all) {
      if (one.ended || found_.count(one.pid) != 0) continue;
      const bool left_behind = one.parent == ::getpid() && carries(one.pid, mark_);
      if (found_.count(one.parent) == 0 && !left_behind) continue;
      found_.insert(one.pid);
      fresh.push_back(one.pid);
    }
  }
  return fresh;
}

void Descent::end(pid_t program) {
  // Again and again, until none is left: who is ended may just have started another, and whose parent is ended becomes
  // a child of this process. By then any other of a number that was found is a stranger. A process may take a while to
  // end, in a driver that does not let go even for ever.
  constexpr int kLooks = 2000;
  for (int i = 0; i < kLooks; ++i) {
    look(program);
    bool left = false;
    for (const Process& one : processes()) {
      const bool kin = one.parent == ::getpid() || found_.count(one.parent) != 0;
      if (one.ended || !kin || found_.count(one.pid) == 0) continue;
      ::kill(one.pid, SIGKILL);
      left = true;
    }
    if (!left) break;
    ::kill(-program, SIGKILL);
    ::usleep(1000);
  }
  for (const pid_t pid : found_) ::waitpid(pid, nullptr, WNOHANG);
}

}  // namespace palpate::process
