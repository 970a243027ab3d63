// SPDX-License-Identifier: MIT
#include "plugin/apart.hpp"

#include "children/child_process.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

constexpr double kPatience = 5.0;  ///< s

/// In the process of its own.
void be_quiet() {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, standard);
  for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) std::signal(crash, SIG_DFL);
}

}  // namespace

std::string look_apart(const std::function<std::string()>& look) {
  const std::unique_ptr<ChildProcess> child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    be_quiet();
    say(look());
    return 0;
  });
  if (!child) throw Error("", fmt::format("no process to look at it: {}", std::strerror(errno)));
  if (!child->wait(kPatience)) throw Error("", fmt::format("came to no end within {:.0f} s", kPatience));
  const int status = child->status();
  if (WIFSIGNALED(status))
    throw Error("", fmt::format("crashed, signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status))));
  if (status != 0 || child->said().empty())
    throw Error("", fmt::format("ended the program with status {}", WEXITSTATUS(status)));
  return child->said();
}

}  // namespace palpate
