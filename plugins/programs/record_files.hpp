// SPDX-License-Identifier: MIT
// Files that a plugin stores in the record of a run: the stderr of a program, and a lock. The lock allows only one
// program at a time to move an arm. Symbolic links are not followed, because the record of another person may contain a
// link to a file of this user.
#pragma once

#include "children/child_process.hpp"

#include <atomic>
#include <chrono>
#include <string>

#include <sys/types.h>

namespace palpate::programs {

/// Throws Error of kind `run`, with `what` and the text of errno as its reason.
[[noreturn]] void fail(const std::string& where, const std::string& what);

/// Interval in which waits check for an interruption.
constexpr std::chrono::milliseconds kPollInterval{20};

/// The end of a wait, and a flag that interrupts it.
struct WaitLimit {
  std::chrono::steady_clock::time_point until;
  const std::atomic<bool>* interrupted = nullptr;  ///< flag that the user sets; may be null

  bool stopped() const { return interrupted != nullptr && interrupted->load(); }
};

/// The stderr of a program. Only its beginning and its end are stored. The program itself appends to the file, so
/// nothing is lost if this process ends. If the file becomes too large, its middle is removed, and a line with the
/// number of removed bytes replaces it.
class StderrLog {
 public:
  static constexpr off_t kFirst = off_t{256} * 1024;  ///< number of bytes stored of the beginning
  static constexpr off_t kLast = off_t{256} * 1024;   ///< least number of bytes stored of the end

  /// Opens or creates `file`. It may already contain output of earlier programs. If the name is empty, nothing is
  /// stored. Throws Error.
  explicit StderrLog(const std::string& file);

  const FileDescriptor& descriptor() const { return file_; }

  /// Removes the middle if the file is too large. Call this function regularly, because the file grows between the
  /// calls.
  void trim();

  /// Returns the last line with text since construction.
  std::string last_words() const;

 private:
  off_t size() const;
  std::string read(off_t begin, off_t end) const;

  FileDescriptor file_;
  off_t begin_ = 0;         ///< size of the file at construction
  long long left_out_ = 0;  ///< bytes removed so far
};

/// Replaces the content of `file` by `text`. Throws Error.
void keep_copy(const std::string& file, const std::string& text);

/// Creates and locks `file`. Returns an empty descriptor if another program still holds the lock at the end of `limit`.
/// A program that inherits the descriptor holds the lock until it and all its descendants with the descriptor have
/// ended, even if this process ends before. Throws Error if `file` cannot be created or locked.
FileDescriptor lock_file(const std::string& file, const WaitLimit& limit);

/// Writes the process id of the program that holds the lock, for messages of later attempts.
void write_holder(const FileDescriptor& lock, pid_t holder);
/// Returns the process id in `file`. Returns "?" if there is none.
std::string read_holder(const std::string& file);

}  // namespace palpate::programs
