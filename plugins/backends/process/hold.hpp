// SPDX-License-Identifier: MIT
// Only one program at a time moves what a run moves, also when the run itself was killed and its program was not.
#pragma once

#include "process/child.hpp"

#include <optional>
#include <string>

namespace palpate::process {

/// The lock of a program on a file. The program inherits it, so that it is held until the program and all that it
/// started and that kept its files are gone, whatever becomes of this process.
class Hold {
 public:
  /// Makes `file` if need be and locks it, once no program holds it any more. None if one still does when the patience
  /// is over. Throws Error if `file` cannot be made or locked.
  static std::optional<Hold> take(const std::string& file, const Patience& patience);

  /// Notes who holds the lock from now on, for the next one that finds it held.
  void note(pid_t holder) const;
  /// The process that was noted last in `file`, "?" if none is.
  static std::string noted(const std::string& file);

  const Descriptor& descriptor() const { return lock_; }

 private:
  explicit Hold(Descriptor lock) : lock_(std::move(lock)) {}
  Descriptor lock_;
};

}  // namespace palpate::process
