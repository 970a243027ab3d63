// SPDX-License-Identifier: MIT
// A running program that is controlled by lines or bytes over pipes. Independent of taps.
#pragma once

#include "children/child_process.hpp"
#include "programs/record_files.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

namespace palpate::programs {

/// Child process with pipes to its stdin and from its stdout. It is in its own process group, so that Ctrl-C in a
/// terminal reaches only palpate. It inherits the environment, the working directory, the three standard files and at
/// most one more.
///
/// The class differs from ChildProcess in several ways: communication during the run, limited line length, a stderr
/// file that outlives this process, and a request to end before a kill. The program is reaped only after all its
/// descendants have ended. Until then its process id, which is that of the group, cannot be reused.
class Child {
 public:
  /// Longest accepted line in bytes, so that a missing line end cannot fill the memory.
  static constexpr std::size_t kLongestLine = 65536;
  /// Largest amount of output in bytes that is buffered during a send; more stays in the pipe.
  static constexpr std::size_t kMostBuffered = std::size_t{64} << 20;
  /// Time limit of each step of the end: after closing stdin, and after SIGTERM.
  static constexpr std::chrono::milliseconds kGrace{1000};

  enum class ReadResult { complete, ended, late, interrupted, too_long };

  /// Starts `program`. Its stderr is appended to the file `stderr_file`, or dropped if the name is empty. The program
  /// inherits the descriptor `kept`, if any. Throws Error if the start fails.
  Child(Program program, const std::string& stderr_file, const Descriptor& kept);
  /// Ends the program: closes its stdin, sends SIGTERM to its group after kGrace, and finally SIGKILL to all
  /// descendants. No process of the program remains.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Writes `text` and buffers output that arrives meanwhile. Returns ReadResult::complete after all is written,
  /// ReadResult::ended if the program does not read any more.
  ReadResult send(const std::string& text, const WaitLimit& limit);
  /// Takes the next line of stdout, without its line end. After `ended`, `too_long` and `late`, `line` is the
  /// incomplete rest.
  ReadResult read(std::string& line, const WaitLimit& limit);
  /// Takes the next `count` bytes of stdout and returns ReadResult::complete. After `ended` and `late`, `bytes` is the
  /// incomplete rest, which also stays in the buffer.
  ReadResult read(std::string& bytes, std::size_t count, const WaitLimit& limit);
  /// Returns a text about the end: "ended with exit status 3, its last output: ...". Waits up to kGrace for the end.
  /// Returns "closed its stdin or stdout" if the program still runs.
  std::string describe_end();

  pid_t pid() const { return pid_; }

 private:
  bool gone() const;
  bool wait_for_end();
  /// Reads available output into the buffer; returns the result of read().
  ssize_t read_some();
  /// Waits for more output. Returns nullopt if there was some, or after kPollInterval without any.
  std::optional<ReadResult> read_more(const WaitLimit& limit);

  // Descendants of the program: all processes that it or they started, even in other groups or sessions, or orphaned.
  void find_descendants();
  void kill_descendants();

  StderrLog stderr_;
  std::string mark_;             ///< NAME=VALUE in the environment, inherited by all descendants
  std::set<pid_t> descendants_;  ///< known descendants and the program itself
  Descriptor input_;             ///< write end of stdin
  Descriptor output_;            ///< read end of stdout
  std::string buffer_;           ///< output that is not taken yet
  pid_t pid_ = -1;
};

}  // namespace palpate::programs
