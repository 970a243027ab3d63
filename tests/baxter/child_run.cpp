// SPDX-License-Identifier: MIT
#include "child_run.hpp"

#include "children/child_process.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

void set_environment(const std::vector<std::string>& environment) {
  for (const std::string& entry : environment) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) {
      unsetenv(entry.c_str());
    } else {
      setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
    }
  }
}

std::string report_of(const std::function<std::string()>& act) {
  try {
    return act();
  } catch (const Error& error) {
    return std::string(error.kind() == Error::Kind::run ? "" : "not of kind run: ") + error.what();
  }
}

}  // namespace

long threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

ChildResult run_in_child(const std::vector<std::string>& environment, const std::function<std::string()>& act) {
  const TemporaryFolder folder;
  const std::string file = folder.write("printed", "").string();
  const auto begin = std::chrono::steady_clock::now();
  const std::unique_ptr<ChildProcess> child = ChildProcess::fork([&](const ChildProcess::Say&) -> int {
    if (std::freopen(file.c_str(), "w", stdout) == nullptr) return 1;
    dup2(STDOUT_FILENO, STDERR_FILENO);
    set_environment(environment);
    std::fputs(report_of(act).c_str(), stdout);
    std::exit(0);
  });
  if (!child) throw std::runtime_error("no process");
  child->wait();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const int status = child->status();
  return {text_of(file), seconds, WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status)};
}

}  // namespace palpate::test
