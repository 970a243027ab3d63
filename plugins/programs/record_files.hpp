// SPDX-License-Identifier: MIT
// Files that a plugin keeps in the record of a run: stderr of a program, and the lock that lets only one program at a
// time move an arm. Symbolic links are not followed, because a record from another person may contain a link to a file
// of this user.
#pragma once

#include "children/child_process.hpp"

#include <atomic>
#include <chrono>
#include <string>

#include <sys/types.h>

namespace palpate::programs {

/// Throws Error (kind `run`) with `what` and the text of errno.
[[noreturn]] void fail(const std::string& where, const std::string& what);

/// Interval in which waits check for an interruption.
constexpr std::chrono::milliseconds kPollInterval{20};

/// End of a wait, and its interruption by the user.
struct WaitLimit {
  std::chrono::steady_clock::time_point until;
  const std::atomic<bool>* interrupted = nullptr;  ///< may be null

  bool stopped() const { return interrupted != nullptr && interrupted->load(); }
};

/// The stderr of a program, limited to its beginning and its end. The program appends to the file by itself, so nothing
/// is lost if this process ends. Beyond the limits the middle is removed, and a line with the number of removed bytes
/// replaces it.
class StderrLog {
 public:
  static constexpr off_t kFirst = off_t{256} * 1024;  ///< bytes kept of the beginning
  static constexpr off_t kLast = off_t{256} * 1024;   ///< least number of bytes kept of the end

  /// Opens or creates `file`, which may contain output of earlier programs. An empty name keeps nothing. Throws Error.
  explicit StderrLog(const std::string& file);

  const Descriptor& descriptor() const { return file_; }

  /// Removes the middle if necessary. Must be called regularly; the file grows between calls.
  void trim();

  /// Returns the last line with text since construction.
  std::string last_words() const;

 private:
  off_t size() const;
  std::string read(off_t begin, off_t end) const;

  Descriptor file_;
  off_t begin_ = 0;         ///< size of the file at construction
  long long left_out_ = 0;  ///< bytes removed so far
};

/// Replaces the content of `file` by `text`. Throws Error.
void keep_copy(const std::string& file, const std::string& text);

/// Creates and locks `file`. Returns an empty descriptor if another program holds the lock until the end of `limit`.
/// A program that inherits the descriptor keeps the lock until it and all descendants with the descriptor have ended,
/// even if this process ends. Throws Error if `file` cannot be created or locked.
Descriptor lock_file(const std::string& file, const WaitLimit& limit);

/// Writes the process id of the lock's holder, for messages of later attempts.
void write_holder(const Descriptor& lock, pid_t holder);
/// Returns the process id in `file`, or "?".
std::string read_holder(const std::string& file);

}  // namespace palpate::programs
