// SPDX-License-Identifier: MIT
#include "cli/interrupt.hpp"

#include <csignal>
#include <cstdlib>
#include <string>

#include <sys/prctl.h>
#include <unistd.h>

namespace palpate::cli {
namespace {

/// The first Ctrl-C asks the run to stop after the tap under way, the second ends the program.
extern "C" void on_key(int signal) {
  if (interrupted.exchange(true)) std::_Exit(128 + signal);
}

/// A terminal that is closed says so more than once; so does a scheduler that ends a job, to each process of it, which
/// also hears it from the one that started it. Nobody means to leave a robot's arm where it is by that.
extern "C" void on_request(int) { interrupted = true; }

bool followed = false;

}  // namespace

std::atomic<bool> interrupted{false};

void listen_for_interrupts() {
  std::signal(SIGINT, on_key);
  std::signal(SIGTERM, on_request);
  if (std::signal(SIGHUP, on_request) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

void follow_parent() {
  const char* const value = std::getenv("PALPATE_PARENT");
  if (value == nullptr) return;
  const std::string parent = value;
  ::unsetenv("PALPATE_PARENT");  // what this program starts is not meant
  followed = true;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (parent != std::to_string(::getppid())) std::_Exit(128 + SIGTERM);  // it has ended meanwhile
}

void keep_parent() {
  if (followed) ::setenv("PALPATE_PARENT", std::to_string(::getppid()).c_str(), 1);
}

bool is_followed() { return followed; }

}  // namespace palpate::cli
