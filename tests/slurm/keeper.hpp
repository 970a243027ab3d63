// SPDX-License-Identifier: MIT
// Daemons that end with the test: they detach themselves from whoever starts them, and what they start in turn does so
// again, so that no test could end them all by itself, least of all one that has been killed.
#pragma once

#include <string>
#include <vector>

namespace palpate::test {

/// A process that starts daemons and inherits all that they leave behind. When it is told to, or when the thread that
/// made it dies, it kills every process that came of them and ends.
class Keeper {
 public:
  /// Runs `commands` one after the other, each to the end of the process that it starts; the daemons among them go on.
  /// What they print goes to the file `log`. `environment` adds NAME=VALUE.
  Keeper(const std::vector<std::vector<std::string>>& commands, const std::vector<std::string>& environment,
         const std::string& log);
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// Whether all commands ended with status 0; waits for it.
  bool ready();

  /// The processes that came of the commands and are alive.
  std::vector<int> processes() const;

 private:
  int pid_ = -1;
  int pipe_ = -1;
};

}  // namespace palpate::test
