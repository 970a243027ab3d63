// SPDX-License-Identifier: MIT
// A program under way, spoken to in lines or in bytes. It knows nothing of taps.
#pragma once

#include "children/child_process.hpp"
#include "programs/recorded.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

namespace palpate::programs {

/// A child process with pipes to its stdin and from its stdout, in a process group of its own, so that Ctrl-C in a
/// terminal reaches only the program that decides what follows from it. It inherits the environment and the working
/// directory, and of open files the three standard ones and at most one more.
///
/// It is spawned as every program is, and for the rest no ChildProcess: it is spoken to while it runs, its lines must
/// not fill the memory, its stderr outlives this process, and it is asked to end before it is killed. Above all it is
/// not reaped before all that it started is dead: until then its number is that of their group, and nobody else's.
class Child {
 public:
  /// A longer line is refused: a program that never ends its line must not fill the memory.
  static constexpr std::size_t kLongestLine = 65536;
  /// So much is taken of its stdout while it is written to; what it says beyond that waits.
  static constexpr std::size_t kMostHeard = std::size_t{64} << 20;
  /// How long a program may take for each step of its end: by itself, and after SIGTERM.
  static constexpr std::chrono::milliseconds kGrace{1000};

  enum class Heard { line, ended, late, interrupted, too_long };

  /// Starts `program`. Its stderr is appended to `diary`, or dropped if that is empty. It inherits `kept` (may be none)
  /// as the file after the standard ones. Throws Error when it cannot be started.
  Child(Program program, const std::string& diary, const Descriptor& kept);
  /// Closes its stdin, which asks it to end, and waits for kGrace; then SIGTERM to its group; then SIGKILL to all that
  /// it started, wherever that has gone. Afterwards nothing of it is left.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Writes `text`, and keeps what it says meanwhile; Heard::line when all of it is in the pipe, Heard::ended when
  /// nobody reads.
  Heard send(const std::string& text, const Patience& patience);
  /// Takes the next line of its stdout, without the line end. With `ended`, `too_long` and `late`, what there is of it.
  Heard hear(std::string& line, const Patience& patience);
  /// Takes the next `count` bytes of its stdout; Heard::line when they are there. With `ended` and `late`, what there
  /// is of them, which stays to be taken.
  Heard hear(std::string& bytes, std::size_t count, const Patience& patience);
  /// How it ended, for people: "ended with exit status 3, its last words: ...". Waits up to kGrace for that; "closed
  /// its stdin or stdout" if it is still there.
  std::string fate();

  pid_t pid() const { return pid_; }

 private:
  bool gone() const;
  bool wait_for_end();
  /// Reads what is in the pipe from its stdout, as read() returns it.
  ssize_t read_some();
  /// Waits for more of its stdout; none when there is, or when a glance brought nothing.
  std::optional<Heard> hear_more(const Patience& patience);

  // All that the program started, and what those started, however far away they have gone: into a group or a session of
  // their own, or left behind by whoever started them.
  void find_kin();
  void end_kin();

  Diary diary_;
  std::string mark_;     ///< NAME=VALUE of its environment, which those that it starts inherit
  std::set<pid_t> kin_;  ///< those that were found, itself too
  Descriptor input_;     ///< we write
  Descriptor output_;    ///< we read
  std::string heard_;    ///< and not yet taken
  pid_t pid_ = -1;
};

}  // namespace palpate::programs
