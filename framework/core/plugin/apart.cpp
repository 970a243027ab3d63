// SPDX-License-Identifier: MIT
#include "plugin/apart.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{5};

[[noreturn]] void be_child(int pipe, const std::function<std::string()>& look) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, standard);
  for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) std::signal(crash, SIG_DFL);
  const std::string answer = look();
  for (std::size_t at = 0; at < answer.size();) {
    const ssize_t written = ::write(pipe, answer.data() + at, answer.size() - at);
    if (written < 0 && errno != EINTR) ::_exit(1);
    at += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
  ::_exit(0);
}

/// All that comes until the other side is closed; false if that takes too long.
bool hear(int pipe, std::string& out) {
  const auto until = Clock::now() + kPatience;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) return false;
    pollfd one{pipe, POLLIN, 0};
    if (::poll(&one, 1, static_cast<int>(left.count())) <= 0) continue;
    std::array<char, 4096> some;
    const ssize_t size = ::read(pipe, some.data(), some.size());
    if (size > 0) out.append(some.data(), static_cast<std::size_t>(size));
    if (size == 0) return true;
  }
}

}  // namespace

std::string look_apart(const std::function<std::string()>& look) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw Error("", fmt::format("no pipe: {}", std::strerror(errno)));
  std::fflush(nullptr);  // or the child would print it again
  const pid_t child = ::fork();
  if (child == 0) be_child(ends[1], look);
  const int why = errno;
  ::close(ends[1]);
  std::string answer;
  const bool ended = child > 0 && hear(ends[0], answer);
  ::close(ends[0]);
  if (child < 0) throw Error("", fmt::format("no process to look at it: {}", std::strerror(why)));
  if (!ended) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!ended) throw Error("", fmt::format("came to no end within {} s", kPatience.count()));
  if (WIFSIGNALED(status))
    throw Error("", fmt::format("crashed, signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status))));
  if (status != 0 || answer.empty())
    throw Error("", fmt::format("ended the program with status {}", WEXITSTATUS(status)));
  return answer;
}

}  // namespace palpate
