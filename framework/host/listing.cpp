// SPDX-License-Identifier: MIT
// Lists all libraries. Each library is loaded in its own child process, which a damaged library may crash or hang.
#include "children/child_process.hpp"
#include "host/builtin.hpp"
#include "host/plugin_host.hpp"

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

constexpr double kLoadSeconds = 5.0;  ///< s

// Exit statuses of the child process, unless the library itself ends the process.
constexpr int kSound = 100;
constexpr int kBroken = 101;

/// Suppresses the output of the child process and its core dumps.
void silence_child() {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, standard);
  for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) std::signal(crash, SIG_DFL);
}

/// Returns the reason why a child process ended without a result; "" if it has a result.
std::string trouble_of(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("crashed, signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  const int ended = WEXITSTATUS(status);
  return ended == kSound || ended == kBroken ? "" : fmt::format("ended the program with status {}", ended);
}

/// Runs `look` in a child process, and stores the summary or the error of a library in `row`.
void load_in_child(const std::function<std::string()>& look, PluginListing& row) {
  const std::unique_ptr<ChildProcess> child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    silence_child();
    try {
      say(look());
    } catch (const Error& trouble) {  // the parent reports it
      say(trouble.what());
      return kBroken;
    }
    return kSound;
  });
  const std::string trouble = !child ? fmt::format("cannot start a child process to load it: {}", std::strerror(errno))
                              : !child->wait(kLoadSeconds) ? fmt::format("did not finish within {:.0f} s", kLoadSeconds)
                                                           : trouble_of(child->status());
  if (!trouble.empty()) {
    row.trouble = fmt::format("{}: loading: {}, build or copy it again", row.file.string(), trouble);
  } else {
    (WEXITSTATUS(child->status()) == kSound ? row.summary : row.trouble) = child->said();
  }
}

}  // namespace

std::vector<PluginListing> PluginHost::list(const std::string& kind, const std::string& name) const {
  std::vector<PluginListing> out;
  for (const std::string& one : kinds()) {
    if (!kind.empty() && one != kind) continue;
    for (const PluginManifest& own : builtin_plugins()) {
      if (own.kind == one && (name.empty() || own.name == name)) out.push_back({one, own.name, {}, own.summary, {}});
    }
    for (const auto& [stem, file] : files(one)) {
      if (!name.empty() && stem != name) continue;
      // The files are sorted by name, so a file of the same name in a second folder comes directly after the first. The
      // first row reports both.
      if (!out.empty() && out.back().kind == one && out.back().name == stem) continue;
      out.push_back({one, stem, file, {}, {}});
      load_in_child([this, &row = out.back()] { return look(row.kind, row.name); }, out.back());
    }
  }
  return out;
}

}  // namespace palpate
