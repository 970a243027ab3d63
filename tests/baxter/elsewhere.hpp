// SPDX-License-Identifier: MIT
// Code of a test in a process of its own: roscpp can be started only once in one, and what it leaves behind is seen
// only from outside.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace palpate::test {

struct Elsewhere {
  std::string printed;   ///< all that came on stdout and stderr
  double seconds = 0.0;  ///< from the beginning of `act` to the end of the process
  int status = 0;        ///< exit status; 128 + signal if a signal ended it
};

/// Runs `act` in a copy of this process, with NAME=VALUE set and NAME unset in its environment, and prints what it
/// returns, or the line of an Error that it throws. The process then ends by exit(0) as from main().
Elsewhere elsewhere(const std::vector<std::string>& environment, const std::function<std::string()>& act);

/// Of this process.
long threads();

}  // namespace palpate::test
