// SPDX-License-Identifier: MIT
#include "cli/interrupt.hpp"

#include <csignal>
#include <cstdlib>
#include <string>

#include <sys/prctl.h>
#include <unistd.h>

namespace palpate::cli {
namespace {

/// The first Ctrl-C stops the run after the current tap. The second one ends the program.
extern "C" void on_key(int signal) {
  if (interrupted.exchange(true)) std::_Exit(128 + signal);
}

/// SIGTERM and SIGHUP only set the flag, even if they arrive repeatedly. A closed terminal sends several of these
/// signals, and a scheduler signals each process of a job. Such repeated signals must not end the program while a
/// robot's arm is in the middle of a motion.
extern "C" void on_request(int) { interrupted = true; }

bool followed = false;

}  // namespace

std::atomic<bool> interrupted{false};

void listen_for_interrupts() {
  std::signal(SIGINT, on_key);
  std::signal(SIGTERM, on_request);
  if (std::signal(SIGHUP, on_request) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // keeps the setting of nohup
}

void follow_parent() {
  const char* const value = std::getenv("PALPATE_PARENT");
  if (value == nullptr) return;
  const std::string parent = value;
  ::unsetenv("PALPATE_PARENT");  // Child processes must not inherit the variable.
  followed = true;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (parent != std::to_string(::getppid())) std::_Exit(128 + SIGTERM);  // The parent has already ended.
}

void keep_parent() {
  if (followed) ::setenv("PALPATE_PARENT", std::to_string(::getppid()).c_str(), 1);
}

bool is_followed() { return followed; }

}  // namespace palpate::cli
