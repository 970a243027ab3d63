// SPDX-License-Identifier: MIT
// Open files that close themselves, and stay away from the numbers of the standard ones.
#pragma once

#include <string>
#include <utility>

namespace palpate::process {

/// An open file of this process, closed in those that it starts.
class Descriptor {
 public:
  Descriptor() = default;
  /// Takes over `number`; -1 stands for none.
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  int number() const { return number_; }
  void close();

 private:
  int number_ = -1;
};

/// Takes over `number`, what opening a file gave, under one above the standard ones even where this process was started
/// without them: a child gets its own standard files first, and they must not hit what it gets after them. Throws Error
/// with the reason in errno if `number` is negative.
Descriptor above_standard(int number);

/// Opens a file of the record, which is made if need be. Throws Error, where it is a link, too: a record from somebody
/// else may hold one, to a file of this user.
Descriptor open_recorded(const std::string& file, int flags);

}  // namespace palpate::process
