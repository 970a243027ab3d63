// SPDX-License-Identifier: MIT
// Runs code of a test in a child process, because roscpp can start only once per process, and its remains are visible
// only from outside.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace palpate::test {

struct ChildResult {
  std::string printed;   ///< all output on stdout and stderr
  double seconds = 0.0;  ///< s from the start of `act` to the end of the process
  int status = 0;        ///< exit status; 128 + signal after a signal
};

/// Runs `act` in a copy of this process with an environment of NAME=VALUE (set) and NAME (unset). The process prints
/// the result, or the line of a thrown Error, and ends by exit(0) as from main().
ChildResult run_in_child(const std::vector<std::string>& environment, const std::function<std::string()>& act);

/// Returns the number of threads of this process.
long threads();

}  // namespace palpate::test
