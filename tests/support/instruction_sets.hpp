// SPDX-License-Identifier: MIT
// Tests on every instruction set that the processor has.
#pragma once

#include "math/instructions.hpp"

#include <algorithm>
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

/// The name of a set as that of a test.
inline std::string test_name(Instructions set) {
  std::string instructions = math::name_of(set);
  instructions.erase(std::remove(instructions.begin(), instructions.end(), '-'), instructions.end());
  return instructions;
}

}  // namespace palpate::test
