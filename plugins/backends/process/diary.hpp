// SPDX-License-Identifier: MIT
// What a program says on its stderr, kept beside the record: its beginning and its end, however much it says.
#pragma once

#include "process/recorded.hpp"

#include <string>

#include <sys/types.h>

namespace palpate::process {

/// A file that a program appends to by itself, so that nothing is lost and nothing waits when this process is gone.
/// Where it grows beyond what is kept, the middle is cut out, and a line there says how much that was.
class Diary {
 public:
  static constexpr off_t kFirst = 256 * 1024;  ///< bytes that are kept of the beginning
  static constexpr off_t kLast = 256 * 1024;   ///< and of the end, at least

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
  bool kept_ = false;
  off_t begin_ = 0;         ///< what others wrote into it before
  long long left_out_ = 0;  ///< bytes
};

}  // namespace palpate::process
