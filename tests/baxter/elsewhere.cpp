// SPDX-License-Identifier: MIT
#include "elsewhere.hpp"

#include <palpate/error.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
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

std::string told(const std::function<std::string()>& act) {
  try {
    return act();
  } catch (const Error& error) {
    return std::string(error.kind() == Error::Kind::run ? "" : "not of kind run: ") + error.what();
  }
}

}  // namespace

Elsewhere elsewhere(const std::vector<std::string>& environment, const std::function<std::string()>& act) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::fflush(nullptr);
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    set_environment(environment);
    std::fputs(told(act).c_str(), stdout);
    std::exit(0);
  }
  close(ends[1]);
  Elsewhere result;
  char buffer[4096];
  for (ssize_t size = 0; (size = read(ends[0], buffer, sizeof buffer)) > 0;) {
    result.printed.append(buffer, static_cast<std::size_t>(size));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return result;
}

}  // namespace palpate::test
