// SPDX-License-Identifier: MIT
#include "keeper.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

/// All processes below `root` that are no zombies.
std::vector<int> descendants_of(int root) {
  std::map<int, std::vector<int>> children;
  std::map<int, bool> alive;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", none)) {
    const int pid = std::atoi(entry.path().filename().c_str());
    std::ifstream in(entry.path() / "stat");
    std::string text;
    if (pid <= 0 || !std::getline(in, text) || text.find_last_of(')') + 4 > text.size()) continue;
    const std::size_t state = text.find_last_of(')') + 2;
    children[std::atoi(text.c_str() + state + 2)].push_back(pid);
    alive[pid] = text[state] != 'Z';
  }
  std::vector<int> all{root};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<int>& more = children[all[i]];
    all.insert(all.end(), more.begin(), more.end());
  }
  all.erase(all.begin());
  all.erase(std::remove_if(all.begin(), all.end(), [&](int pid) { return !alive[pid]; }), all.end());
  return all;
}

void reap_all() {
  while (::waitpid(-1, nullptr, WNOHANG) > 0) {
  }
}

class KeeperProcess {
 public:
  explicit KeeperProcess(int parent) {
    ::sigemptyset(&awaited_);
    ::sigaddset(&awaited_, SIGTERM);
    ::sigaddset(&awaited_, SIGCHLD);
    ::sigprocmask(SIG_BLOCK, &awaited_, &before_);
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(1);  // the test was gone before the line above
  }

  /// Runs a command to its end; whether it ended well, and before this process was told to end.
  bool run(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int pid = ::fork();
    if (pid == 0) {
      ::sigprocmask(SIG_SETMASK, &before_, nullptr);
      ::execvp(arguments.front(), arguments.data());
      ::_exit(127);
    }
    while (pid > 0) {
      int status = 0;
      const int ended = ::waitpid(-1, &status, WNOHANG);
      if (ended == pid) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
      if (ended <= 0 && !stays()) return false;
    }
    return false;
  }

  /// Reaps until it is told to end.
  void stay() {
    while (!told_) {
      reap_all();
      stays();
    }
  }

  /// Kills what came of the commands, until nothing is left to kill.
  [[noreturn]] static void end() {
    for (std::vector<int> left = descendants_of(::getpid()); !left.empty(); left = descendants_of(::getpid())) {
      for (const int pid : left) ::kill(pid, SIGKILL);
      reap_all();
      ::usleep(1000);  // between two looks: that grandchildren are gone is told to nobody
    }
    reap_all();
    ::_exit(0);
  }

 private:
  /// Waits for a signal; whether it is none to end.
  bool stays() {
    if (::sigwaitinfo(&awaited_, nullptr) == SIGTERM) told_ = true;
    return !told_;
  }

  sigset_t awaited_{};
  sigset_t before_{};
  bool told_ = false;
};

}  // namespace

Keeper::Keeper(const std::vector<std::vector<std::string>>& commands, const std::vector<std::string>& environment,
               const std::string& log) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe to a keeper");
  const int parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ > 0) {
    ::close(ends[1]);
    pipe_ = ends[0];
    return;
  }
  KeeperProcess keeper(parent);
  // What ctest reads must not stay open because of a daemon.
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  ::dup2(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), STDOUT_FILENO);
  ::dup2(STDOUT_FILENO, STDERR_FILENO);
  for (const std::string& one : environment) ::putenv(const_cast<char*>(one.c_str()));
  const bool well =
      std::all_of(commands.begin(), commands.end(), [&](const auto& command) { return keeper.run(command); });
  const char answer = well ? 'y' : 'n';
  if (::write(ends[1], &answer, 1) == 1) keeper.stay();
  KeeperProcess::end();
}

Keeper::~Keeper() {
  ::kill(pid_, SIGTERM);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  ::close(pipe_);
}

bool Keeper::ready() {
  char answer = 'n';
  return ::read(pipe_, &answer, 1) == 1 && answer == 'y';
}

std::vector<int> Keeper::processes() const { return descendants_of(pid_); }

}  // namespace palpate::test
