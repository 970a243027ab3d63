// SPDX-License-Identifier: MIT
// Names of instruction sets, the choice of one by the environment, and the version of a loop that belongs to it.
#pragma once

#include <palpate/instructions.hpp>

#include <array>
#include <vector>

namespace palpate::math {

/// AVX-512, AVX2, NEON or baseline.
const char* name_of(Instructions set);

/// The sets that this processor has and loops are compiled for, the widest first.
std::vector<Instructions> instruction_sets();

/// Follows the environment variable PALPATE_INSTRUCTIONS: the set that it names; the widest if it is unset or empty.
/// Loops give the same bytes with AVX2, AVX-512 and NEON, and other last digits with `baseline`, which has no fused
/// multiplication and addition. Throws Error if the processor has no set of that name.
Instructions choose_instructions();

/// Of a function that is compiled for several sets, in their order and null for those that are not, the one to call.
template <class Function>
Function version_of(const std::array<Function, 4>& versions) {
  const Function own = versions[static_cast<std::size_t>(instructions_in_use())];
  return own != nullptr ? own : versions[0];
}

}  // namespace palpate::math
