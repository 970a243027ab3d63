// SPDX-License-Identifier: MIT
// Numbers in binary files.
#pragma once

#include <cstddef>
#include <cstring>

namespace palpate {

/// A type of number as it lies in a file: how many bytes it has, and their value, the least significant byte first.
struct BinaryNumber {
  std::size_t size;
  double (*read)(const char* bytes);
};

template <class Number>
constexpr BinaryNumber binary_number() {
  return {sizeof(Number), [](const char* bytes) {
            Number out;
            std::memcpy(&out, bytes, sizeof out);
            return static_cast<double>(out);
          }};
}

}  // namespace palpate
