// SPDX-License-Identifier: MIT
// All that a program started, and what those started, however far away they have gone: into a group or a session of
// their own, or left behind by whoever started them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

namespace palpate::process {

class Descent {
 public:
  /// From now on the processes that a program leaves behind become this one's children. To be made before it starts.
  Descent();

  /// NAME=VALUE for the program's environment, which those that it starts inherit.
  const std::string& mark() const { return mark_; }

  /// Finds what there is of the descent of `program` now; what was not known before. To be called before the program is
  /// asked to end: whoever it leaves behind without the mark is known by then.
  std::vector<pid_t> look(pid_t program);

  /// Ends, with SIGKILL, `program`, which has not been reaped yet, its group, and all of its descent, and reaps what of
  /// that is a child of this process.
  void end(pid_t program);

 private:
  std::string mark_;
  std::set<pid_t> found_;  ///< the program, too
};

}  // namespace palpate::process
