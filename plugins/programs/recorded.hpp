// SPDX-License-Identifier: MIT
// Files that this plugin keeps beside the program's own record: what the program said on its stderr, and the lock by
// which only one of them at a time moves what a run moves. Nothing is written through a link: a record from somebody
// else may hold one, to a file of this user.
#pragma once

#include "children/child_process.hpp"

#include <atomic>
#include <chrono>
#include <string>

#include <sys/types.h>

namespace palpate::programs {

/// Throws Error (kind `run`): what cannot be done, in words, and why, as errno has it.
[[noreturn]] void fail(const std::string& where, const std::string& what);

/// How often a wait looks whether the user wants to stop.
constexpr std::chrono::milliseconds kGlance{20};

/// Until when to wait, and what breaks the wait off.
struct Patience {
  std::chrono::steady_clock::time_point until;
  const std::atomic<bool>* interrupted = nullptr;  ///< may be null

  bool broken_off() const { return interrupted != nullptr && interrupted->load(); }
};

/// What a program says on its stderr, its beginning and its end, however much it says: a file that it appends to by
/// itself, so that nothing is lost and nothing waits when this process is gone. Where it grows beyond what is kept, the
/// middle is cut out, and a line there says how much that was.
class Diary {
 public:
  static constexpr off_t kFirst = off_t{256} * 1024;  ///< bytes that are kept of the beginning
  static constexpr off_t kLast = off_t{256} * 1024;   ///< and of the end, at least

  /// Opens or makes `file`, which may hold what an earlier program said; an empty name keeps nothing. Throws Error.
  explicit Diary(const std::string& file);

  const Descriptor& descriptor() const { return file_; }

  /// Cuts the middle out if need be. To be called every now and then: in between it grows as it is written.
  void trim();

  /// The last line with text since this was made.
  std::string last_words() const;

 private:
  off_t size() const;
  std::string read(off_t begin, off_t end) const;

  Descriptor file_;
  off_t begin_ = 0;         ///< what others wrote into it before
  long long left_out_ = 0;  ///< bytes
};

/// Writes `text` into `file`, over what was there. Throws Error.
void keep_copy(const std::string& file, const std::string& text);

/// Makes `file` if need be and locks it, once no program holds it any more; none if one still does when the patience is
/// over. The program that inherits it holds it until that and all that it started and that kept its files are gone,
/// whatever becomes of this process. Throws Error if `file` cannot be made or locked.
Descriptor locked(const std::string& file, const Patience& patience);

/// Notes who holds the lock from now on, for the next one that finds it held.
void note_holder(const Descriptor& lock, pid_t holder);
/// The process that was noted last in `file`, "?" if none is.
std::string noted_holder(const std::string& file);

}  // namespace palpate::programs
