// SPDX-License-Identifier: MIT
// Types of numbers in binary files.
#pragma once

#include <cstddef>
#include <cstring>

namespace palpate {

/// Type of a number in a file: its size in bytes, and a function that converts little-endian bytes to a value.
struct BinaryNumberType {
  std::size_t size;
  double (*read)(const char* bytes);
};

template <class Number>
constexpr BinaryNumberType binary_number() {
  return {sizeof(Number), [](const char* bytes) {
            Number out;
            std::memcpy(&out, bytes, sizeof out);
            return static_cast<double>(out);
          }};
}

}  // namespace palpate
