// SPDX-License-Identifier: MIT
// A running program with which this process exchanges lines or bytes over pipes. The code does not depend on taps.
#pragma once

#include "children/child_process.hpp"
#include "programs/record_files.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <set>
#include <string>

#include <sys/types.h>

namespace palpate::programs {

/// Child process with pipes to its stdin and from its stdout. It is in a separate process group, so that Ctrl-C in a
/// terminal reaches only palpate. It inherits the environment, the working directory, its three standard files, and at
/// most one more descriptor.
///
/// In contrast to ChildProcess, this class communicates with the running program, limits the length of lines, and asks
/// the program to end before it kills it. The program also writes its stderr to a file that outlives this process. The
/// ended program is reaped (its process id is released) only after all its descendants have ended. Until then, no other
/// process can get this id, which is also the id of the group.
class Child {
 public:
  /// Longest accepted line in bytes. Without this limit, a missing line end could fill the memory.
  static constexpr std::size_t kLongestLine = 65536;
  /// Largest amount of output in bytes that is buffered during a send. Further output stays in the pipe.
  static constexpr std::size_t kMostBuffered = std::size_t{64} << 20;
  /// Time limit for each step of the end: after stdin is closed, and after SIGTERM.
  static constexpr std::chrono::milliseconds kGrace{1000};

  enum class ReadResult { complete, ended, late, interrupted, too_long };

  /// Starts `program`. The stderr of the program is appended to the file `stderr_file`. If the name is empty, stderr is
  /// dropped. If `kept` is not empty, the program inherits this descriptor. Throws Error if the program cannot be
  /// started.
  Child(ProgramCall program, const std::string& stderr_file, const FileDescriptor& kept);
  /// Ends the program. Closes its stdin, sends SIGTERM to its group after kGrace, and finally sends SIGKILL to all
  /// descendants. Afterwards, no process of the program remains.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Writes `text` and buffers output that arrives meanwhile. Returns ReadResult::complete after all is written.
  /// Returns ReadResult::ended if the program no longer reads.
  ReadResult send(const std::string& text, const WaitLimit& limit);
  /// Removes the next line of stdout from the buffer and returns it in `line`, without its line end. If the result is
  /// `ended`, `too_long` or `late`, `line` is the incomplete rest.
  ReadResult read(std::string& line, const WaitLimit& limit);
  /// Removes the next `count` bytes of stdout from the buffer and returns ReadResult::complete. If the result is
  /// `ended` or `late`, `bytes` is the incomplete rest, which also stays in the buffer.
  ReadResult read(std::string& bytes, std::size_t count, const WaitLimit& limit);
  /// Returns a text about the end of the program: "ended with exit status 3, its last output: ...". Waits up to kGrace
  /// for this end. Returns "closed its stdin or stdout" if the program still runs.
  std::string describe_end();

  pid_t pid() const { return pid_; }

 private:
  bool gone() const;
  bool wait_for_end();
  /// Reads available output into the buffer. Returns the result of the system call read().
  ssize_t read_some();
  /// Waits for more output. Returns nullopt if output arrived, and after kPollInterval without output.
  std::optional<ReadResult> read_more(const WaitLimit& limit);

  // Finds the descendants of the program: all processes that the program or a descendant started. They may be in other
  // groups or sessions, or orphaned.
  void find_descendants();
  void kill_descendants();

  StderrLog stderr_;
  std::string mark_;             ///< NAME=VALUE in the environment of the program; all descendants inherit it
  std::set<pid_t> descendants_;  ///< known descendants, and the program
  FileDescriptor input_;         ///< write end of stdin
  FileDescriptor output_;        ///< read end of stdout
  std::string buffer_;           ///< output that no read() has returned yet
  pid_t pid_ = -1;
};

}  // namespace palpate::programs
