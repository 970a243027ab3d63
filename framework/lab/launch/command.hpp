// SPDX-License-Identifier: MIT
// Programs of the system, run without a shell, and what they say.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A program under way. It is found on PATH, reads nothing, and is in a process group of its own: the terminal's Ctrl-C
/// does not reach it, so it is never cut off in the middle of what it does.
class Command {
 public:
  /// Starts `words`; of the environment it sees the variables whose names `sees` keeps. Throws Error when it is not
  /// installed or cannot be started.
  explicit Command(const std::vector<std::string>& words,
                   const std::function<bool(std::string_view name)>& sees = nullptr);
  /// Kills it if it still runs.
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  /// Waits for its end, but not for more than `seconds`, nor beyond a signal. Returns whether it has ended.
  bool wait(double seconds);

  /// How it ended: exit status, 128 + signal if a signal ended it.
  int status() const { return status_; }
  /// What it wrote so far, stdout and stderr as they came.
  const std::string& output() const { return output_; }

 private:
  void reap();

  int pid_ = -1;
  int pipe_ = -1;
  int status_ = 0;
  std::string output_;
};

/// `text` as one word of a shell, in quotes only where it needs them.
std::string shell_word(const std::string& text);

}  // namespace palpate
