// SPDX-License-Identifier: MIT
// Tests on every instruction set that the processor has.
#pragma once

#include "math/instructions.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate::test {

/// While it lives, loops use the set of this name.
class OnInstructions {
 public:
  explicit OnInstructions(Instructions set) { use_instructions(set); }
  ~OnInstructions() { math::choose_instructions(); }
  OnInstructions(const OnInstructions&) = delete;
  OnInstructions& operator=(const OnInstructions&) = delete;
};

/// FNV-1a over the bytes of numbers, and of those whose hash `before` is.
inline std::uint64_t hash_of(const double* numbers, std::size_t count, std::uint64_t before = 0xcbf29ce484222325ULL) {
  const auto* const bytes = reinterpret_cast<const unsigned char*>(numbers);
  for (std::size_t i = 0; i < count * sizeof(double); ++i) before = (before ^ bytes[i]) * 0x100000001b3ULL;
  return before;
}

/// The name of a set as that of a test.
inline std::string test_name(Instructions set) {
  std::string instructions = math::name_of(set);
  instructions.erase(std::remove(instructions.begin(), instructions.end(), '-'), instructions.end());
  return instructions;
}

}  // namespace palpate::test
